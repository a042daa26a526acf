#include "rbvi/contact/curve.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace rbvi {

namespace {

/// Values of the edges of a polyline at its nodes, weighted by length.
Vector means_at_nodes(const Matrix &points, const Vector &of_edges) {
  Vector sum = Vector::Zero(points.rows()), weight = Vector::Zero(points.rows());
  for (Index e = 0; e < of_edges.size(); ++e) {
    const double length = (points.row(e + 1) - points.row(e)).norm();
    sum.segment<2>(e).array() += length * of_edges[e];
    weight.segment<2>(e).array() += length;
  }
  return sum.cwiseQuotient(weight);
}

} // namespace

std::array<double, 2> hat_weights(const Point &begin, const Point &end, bool axisymmetric) {
  const double half = edge_length(begin, end) / 2;
  return {half * circumference(axisymmetric, (2 * begin + end) / 3),
          half * circumference(axisymmetric, (begin + 2 * end) / 3)};
}

NodalCurve::NodalCurve(std::vector<Point> nodes, int degree)
    : nodes_(std::move(nodes)), degree_(degree), edges_((std::ssize(nodes_) - 1) / degree) {}

std::vector<double> NodalCurve::lengths() const {
  std::vector<double> lengths;
  lengths.reserve(edges_);
  for (Index e = 0; e < edges_; ++e)
    lengths.push_back(edge_length(nodes_[e], nodes_[e + 1]));
  return lengths;
}

std::vector<std::array<double, 2>> NodalCurve::hats(bool axisymmetric) const {
  std::vector<std::array<double, 2>> hats;
  for (Index e = 0; e < edges_; ++e)
    hats.push_back(hat_weights(nodes_[e], nodes_[e + 1], axisymmetric));
  return hats;
}

Index check_curve(const InterfaceMesh &mesh, std::size_t part, const std::string &name) {
  if (mesh.dim != 2)
    throw bad_input("the " + name + " is a curve in two dimensions: the mesh has " +
                    std::to_string(mesh.dim));
  const int nodes = part < mesh.parts.size() ? mesh.parts[part] : 0;
  if (nodes < 1 + mesh.degree || (nodes - 1) % mesh.degree != 0)
    throw bad_input("the " + name + " needs at least one edge, but has " + std::to_string(nodes) +
                    (nodes == 1 ? " node" : " nodes") + " of degree " +
                    std::to_string(mesh.degree));
  int first = 0, first_edge = 0; // of this part
  for (std::size_t before = 0; before < part; ++before) {
    first += mesh.parts[before];
    first_edge += (mesh.parts[before] - 1) / mesh.degree;
  }
  const int vertices = (nodes - 1) / mesh.degree + 1;
  for (int i = 1; i < vertices; ++i) {
    const Point &before = mesh.points[first + i - 1], &here = mesh.points[first + i];
    if (!(before[0] < here[0]))
      throw bad_input("x must increase along the " + name + ", but vertex " + std::to_string(i) +
                      " at x = " + short_number(here[0]) +
                      " follows x = " + short_number(before[0]));
  }
  for (int e = 0; e + 1 < vertices; ++e) {
    const std::array<int, 3> expected{first + e, first + e + 1, first + vertices + e};
    if (mesh.per_entity != mesh.degree + 1 || first_edge + e >= mesh.count() ||
        !std::equal(expected.begin(), expected.begin() + mesh.per_entity,
                    mesh.nodes_of(first_edge + e)))
      throw bad_input("edge " + std::to_string(e) + " of the " + name +
                      " does not go from vertex to vertex");
  }
  return vertices;
}

SparseMatrix linear_gram(const std::vector<Point> &points, int copies, bool axisymmetric) {
  const auto vertices = static_cast<Index>(points.size()), rows = vertices * copies;
  const auto length_of = [&](Index edge) { return edge_length(points[edge], points[edge + 1]); };
  const auto around = [&](const Point &x) { return circumference(axisymmetric, x); };
  SparseMatrix product(rows, rows);
  product.reserve(Eigen::VectorXi::Constant(rows, 3));
  // The mean radius that the product of two hats sees on an edge is that of 3 parts of its end to
  // one of the other for a square, else that of the middle.
  for (Index row = 0; row < rows; ++row) {
    const Index i = row % vertices;
    double diagonal = 0;
    for (const Index other : {i - 1, i + 1}) {
      if (other < 0 || other >= vertices) continue;
      const Point &x = points[i], &y = points[other];
      const double length = length_of(std::min(i, other));
      product.insert(row, row + other - i) = length / 6 * around((x + y) / 2);
      diagonal += length * around((3 * x + y) / 4);
    }
    product.insert(row, row) = diagonal / 3;
  }
  product.makeCompressed();
  return product;
}

Grid polyline(const Scene &scene, const FullMu &mu, const InterfaceMesh &mesh,
              const std::vector<Index> &nodes, const Vector &u) {
  const Vector moved = moved_nodes(scene, mu, mesh, u);
  const auto count = static_cast<Index>(nodes.size());
  std::vector<Point> points;
  std::vector<int> edges;
  Vector of_nodes(3 * count);
  for (Index k = 0; k < count; ++k) {
    const Index node = nodes[k];
    points.push_back(mesh.points[node]);
    of_nodes.segment<3>(3 * k) = moved.segment<3>(3 * node);
    if (k > 0) edges.insert(edges.end(), {static_cast<int>(k) - 1, static_cast<int>(k)});
  }
  return {mapped_points(scene, mu, points), edges, 2, {{"u", of_nodes, "m"}}, {}, {}};
}

void add_pressure(const Vector &values, Grid &grid) {
  const bool of_edges = values.size() < grid.points.rows();
  if (of_edges) grid.of_cells.push_back({"pressure", values, "Pa"});
  grid.of_nodes.push_back(
      {"pressure", of_edges ? means_at_nodes(grid.points, values) : values, "Pa"});
}

} // namespace rbvi
