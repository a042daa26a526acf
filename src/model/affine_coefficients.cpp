#include "rbvi/model/affine_coefficients.hpp"

#include "rbvi/contact/entity_sum.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/formula.hpp"
#include "rbvi/element/geometry.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/model/packed.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// The vertices of sampled cells or edges, and where the map takes them.
struct SampleVertices {
  std::vector<Point> reference, mapped;
};

SampleVertices vertices_of(const SampleMesh &sample, const Scene &scene, const FullMu &mu) {
  SampleVertices vertices;
  for (Index i = 0; i < sample.vertices.rows(); ++i)
    vertices.reference.push_back(point_of(sample.vertices, i));
  vertices.mapped = images(scene.map, mu, vertices.reference);
  return vertices;
}

/// A sampled cell or edge.
Cell sample_cell(const SampleMesh &sample, const SampleVertices &vertices, const Scene &scene,
                 const FullMu &mu, Index number) {
  Cell cell{sample.corners - 1, {}, {}};
  for (int i = 0; i < sample.corners; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const auto vertex = static_cast<std::size_t>(number * sample.corners + i);
    cell.reference[at] = vertices.reference[vertex];
    cell.mapped[at] = vertices.mapped[vertex];
  }
  if (cell.dim == scene.dim) check_orientation(scene, mu, cell);
  if (!sample.imposed_by.empty()) {
    const Index cells = sample.vertices.rows() / sample.corners;
    cell.imposed_by = sample.imposed_by.data() + number * (std::ssize(sample.imposed_by) / cells);
  }
  return cell;
}

} // namespace

Vector affine_coefficients(const AffineTerms &terms, const Sum &sum, const Scene &scene,
                           const FullMu &all_parameters) {
  const std::vector<double> exact =
      exact_coefficients(sum, split_sum(sum, scene.parameters), scene.parameters, all_parameters);
  Vector result(terms.size());
  result.head(terms.exact) = Eigen::Map<const Vector>(exact.data(), std::ssize(exact));
  auto theta = result.tail(terms.size() - terms.exact);
  theta.setZero();
  if (theta.size() == 0) return result;
  const SampleMesh &sample = terms.samples.front();
  const Index cells = sample.vertices.rows() / sample.corners;
  const Index dofs = Index{nodes_per_cell(scene.dim, scene.degree)} * scene.components;
  const SampleVertices vertices = vertices_of(sample, scene, all_parameters);
  Matrix values(dofs * dofs, cells); // a linear form, or one on a facet, fills the first rows only
  for (Index number = 0; number < cells; ++number) {
    const int term = sample.terms[number];
    sum[term].form.kernel(all_parameters,
                          sample_cell(sample, vertices, scene, all_parameters, number),
                          values.col(number).data());
  }
  for (const SampleMesh::Contribution &c : sample.contributions)
    theta[c.entry] += values(c.local, c.cell);
  terms.interpolation.triangularView<Eigen::UnitLower>().solveInPlace(theta);
  if (!result.allFinite())
    throw bad_input("a stiffness or a load is not finite at " +
                    describe(scene.parameters, all_parameters) +
                    ": some function in the terms of a or f is not, at some point of the body");
  return result;
}

Vector contact_coefficients(const AffineTerms &terms, Part part, const Contact &contact,
                            const Scene &scene, const FullMu &all_parameters) {
  Vector theta = Vector::Zero(terms.size());
  for (std::size_t i = 0; i < terms.samples.size(); ++i) {
    const EntitySum &interface = *contact.interfaces[i]->entity_sum();
    const SampleMesh &sample = terms.samples[i];
    const auto entities = static_cast<std::size_t>(sample.vertices.rows() / sample.corners);
    const SampleVertices vertices = vertices_of(sample, scene, all_parameters);
    std::vector<EntityValues> values(entities, interface.shape());
    for (std::size_t e = 0; e < entities; ++e)
      interface.integrate_beside_imposed(
          all_parameters,
          sample_cell(sample, vertices, scene, all_parameters, static_cast<Index>(e)), values[e]);
    for (const SampleMesh::Contribution &c : sample.contributions) {
      const EntityValues &of = values[c.cell];
      theta[c.entry] += part == Part::b ? of.b.data()[c.local] : of.g[c.local];
    }
  }
  terms.interpolation.triangularView<Eigen::UnitLower>().solveInPlace(theta);
  return theta;
}

void stiffness_of(const ReducedModel &model, const Vector &theta, Matrix &lower) {
  const StiffnessChange &change = model.body.a_change;
  const Index n = model.primal_size(), r = change.rank();
  lower.resize(n, n);
  if (r == 0) return unpack(model.body.a.reduced * theta, lower);
  unpack(model.body.a.reduced.col(0) * change.scales.dot(theta), lower);
  lower.triangularView<Eigen::Lower>() +=
      change.range * unpacked(change.cores * theta, r) * change.range.transpose();
}

double energy_product(const ReducedModel &model, const Vector &theta, const Vector &u) {
  const StiffnessChange &change = model.body.a_change;
  const bool changes = change.rank() > 0;
  const Vector factors = changes ? Vector::Constant(1, change.scales.dot(theta)) : theta;
  const Index n = u.size();
  double sum = 0;
  for (Index q = 0; q < factors.size(); ++q)
    for (Index j = 0, at = 0; j < n; at += n - j, ++j) {
      const auto column = model.body.a.reduced.col(q).segment(at, n - j);
      sum += factors[q] * u[j] * (2 * column.dot(u.tail(n - j)) - column[0] * u[j]);
    }
  if (!changes) return sum;
  const Vector moved = change.range.transpose() * u;
  return sum + moved.dot(unpacked(change.cores * theta, change.rank()) * moved);
}

void check_terms_of(const AffineTerms &terms, const Sum &sum, const ParameterSpace &space,
                    const std::string &name) {
  const SplitSum split = split_sum(sum, space);
  bool fits = terms.exact == std::ssize(split.exact);
  for (const SampleMesh &sample : terms.samples) {
    fits = fits && std::ssize(sample.terms) * sample.corners == sample.vertices.rows();
    for (const int term : sample.terms)
      fits = fits && std::ranges::find(split.mapped, term) != split.mapped.end();
  }
  if (!fits)
    throw bad_input("the terms of " + name +
                    " of the model are not those of its scene in this build");
}

} // namespace rbvi
