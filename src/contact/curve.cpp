#include "rbvi/contact/curve.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <cmath>
#include <numeric>

namespace rbvi {

Index check_curve(const InterfaceMesh &mesh, std::size_t part, const std::string &name) {
  if (mesh.dim != 2)
    throw bad_input("the " + name + " is a curve in two dimensions: the mesh has " +
                    std::to_string(mesh.dim));
  const auto begin = std::accumulate(mesh.parts.begin(),
                                     mesh.parts.begin() + static_cast<Index>(part), std::size_t{0});
  const int nodes = mesh.parts.at(part);
  if (nodes < 1 + mesh.degree || (nodes - 1) % mesh.degree != 0)
    throw bad_input("the " + name + " needs at least one edge, but has " + std::to_string(nodes) +
                    (nodes == 1 ? " node" : " nodes") + " of degree " +
                    std::to_string(mesh.degree));
  const Index vertices = (nodes - 1) / mesh.degree + 1;
  for (Index i = 1; i < vertices; ++i) {
    const Point &before = mesh.points[begin + static_cast<std::size_t>(i) - 1],
                &here = mesh.points[begin + static_cast<std::size_t>(i)];
    if (!(before[0] < here[0]))
      throw bad_input("x must increase along the " + name + ", but vertex " + std::to_string(i) +
                      " at x = " + short_number(here[0]) +
                      " follows x = " + short_number(before[0]));
  }
  return vertices;
}

SparseMatrix linear_gram(const std::vector<Point> &points, int copies) {
  const auto vertices = static_cast<Index>(points.size()), rows = vertices * copies;
  const auto length = [&](Index edge) {
    const Point &a = points[static_cast<std::size_t>(edge)],
                &b = points[static_cast<std::size_t>(edge) + 1];
    return std::hypot(b[0] - a[0], b[1] - a[1]);
  };
  SparseMatrix product(rows, rows);
  product.reserve(Eigen::VectorXi::Constant(rows, 3));
  for (Index row = 0; row < rows; ++row) {
    const Index i = row % vertices;
    const double before = i > 0 ? length(i - 1) : 0, after = i + 1 < vertices ? length(i) : 0;
    if (i > 0) product.insert(row, row - 1) = before / 6;
    product.insert(row, row) = (before + after) / 3;
    if (i + 1 < vertices) product.insert(row, row + 1) = after / 6;
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
    const Index node = nodes[static_cast<std::size_t>(k)];
    points.push_back(mesh.points[static_cast<std::size_t>(node)]);
    of_nodes.segment<3>(3 * k) = moved.segment<3>(3 * node);
    if (k > 0) edges.insert(edges.end(), {static_cast<int>(k) - 1, static_cast<int>(k)});
  }
  return {mapped_points(scene, mu, points), edges, 2, {{"u", of_nodes, "m"}}, {}, {}};
}

} // namespace rbvi
