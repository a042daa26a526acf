#include "stored_operators.hpp"

#include "rbvi/core/error.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// Of sampled entries on one mesh.
void write_sample(H5Writer &file, const std::string &group, const SampleMesh &sample) {
  std::vector<int> triples;
  for (const SampleMesh::Contribution &c : sample.contributions)
    triples.insert(triples.end(), {c.entry, c.cell, c.local});
  file.write(group + "/vertices", sample.vertices);
  file.write(group + "/corners", sample.corners);
  file.write(group + "/contributions", triples);
  file.write(group + "/cell_terms", sample.terms);
  file.write(group + "/cell_imposed_by", sample.imposed_by);
}

SampleMesh read_sample(const H5Reader &file, const std::string &group) {
  SampleMesh sample;
  sample.vertices = file.matrix(group + "/vertices");
  sample.corners = file.integer(group + "/corners");
  const std::vector<int> triples = file.ints(group + "/contributions");
  sample.terms = file.ints(group + "/cell_terms");
  sample.imposed_by = file.ints(group + "/cell_imposed_by");
  if (triples.size() % 3 != 0) throw bad_input(group + "/contributions are not triples");
  for (std::size_t i = 0; i < triples.size(); i += 3)
    sample.contributions.push_back({triples[i], triples[i + 1], triples[i + 2]});
  return sample;
}

Matrix as_matrix(const std::vector<Point> &points, int dim) {
  Matrix result(static_cast<Index>(points.size()), dim);
  for (Index i = 0; i < result.rows(); ++i)
    for (Index c = 0; c < dim; ++c)
      result(i, c) = points[i][c];
  return result;
}

} // namespace

void write_terms(H5Writer &file, const std::string &group, const AffineTerms &terms) {
  file.write(group + "/reduced", terms.reduced);
  file.write(group + "/interpolation", terms.interpolation);
  file.write(group + "/error", terms.error);
  file.write(group + "/samples", static_cast<int>(terms.samples.size()));
  for (std::size_t i = 0; i < terms.samples.size(); ++i)
    write_sample(file, group + "/" + std::to_string(i), terms.samples[i]);
  file.write(group + "/exact", terms.exact);
}

AffineTerms read_terms(const H5Reader &file, const std::string &group) {
  AffineTerms terms;
  terms.reduced = file.matrix(group + "/reduced");
  terms.interpolation = file.matrix(group + "/interpolation");
  terms.error = file.number(group + "/error");
  for (int i = 0; i < file.integer(group + "/samples"); ++i)
    terms.samples.push_back(read_sample(file, group + "/" + std::to_string(i)));
  terms.exact = file.integer(group + "/exact");
  return terms;
}

void write_interfaces(H5Writer &file, const std::vector<InterfaceModel> &interfaces) {
  file.write("interfaces/count", static_cast<int>(interfaces.size()));
  for (std::size_t i = 0; i < interfaces.size(); ++i) {
    const std::string group = "interfaces/" + std::to_string(i);
    const InterfaceMesh &mesh = interfaces[i].mesh;
    file.write(group + "/sizes",
               std::vector<int>{mesh.dim, mesh.degree, mesh.components, mesh.per_entity});
    file.write(group + "/points", as_matrix(mesh.points, mesh.dim));
    file.write(group + "/entities", mesh.entities);
    file.write(group + "/edges", mesh.edges);
    file.write(group + "/parts", mesh.parts);
    file.write(group + "/dofs", mesh.dofs);
    file.write(group + "/imposed_by", mesh.imposed_by);
    file.write(group + "/nodes", interfaces[i].nodes);
  }
}

std::vector<InterfaceModel> read_interfaces(const H5Reader &file, Index columns) {
  std::vector<InterfaceModel> interfaces;
  for (int i = 0; i < file.integer("interfaces/count"); ++i) {
    const std::string group = "interfaces/" + std::to_string(i);
    const std::vector<int> sizes = file.ints(group + "/sizes");
    if (sizes.size() != 4) throw bad_input(group + "/sizes has not 4 entries");
    InterfaceModel interface;
    InterfaceMesh &mesh = interface.mesh;
    mesh.dim = sizes[0];
    mesh.degree = sizes[1];
    mesh.components = sizes[2];
    mesh.per_entity = std::max(1, sizes[3]);
    mesh.columns = columns;
    const Matrix points = file.matrix(group + "/points");
    if (mesh.dim < 2 || mesh.dim > 3 || points.cols() != mesh.dim)
      throw bad_input(group + "/points does not fit " + group + "/sizes");
    for (Index k = 0; k < points.rows(); ++k)
      mesh.points.push_back(point_of(points, k));
    mesh.entities = file.ints(group + "/entities");
    mesh.edges = file.ints(group + "/edges");
    mesh.parts = file.ints(group + "/parts");
    mesh.dofs = file.ints(group + "/dofs");
    mesh.imposed_by = file.ints(group + "/imposed_by");
    interface.nodes = file.ints(group + "/nodes");
    interfaces.push_back(std::move(interface));
  }
  return interfaces;
}

} // namespace rbvi
