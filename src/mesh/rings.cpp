#include "rings.hpp"

#include "rbvi/element/geometry.hpp"

namespace rbvi {

namespace {

double quality(const SerialMesh &mesh, const std::array<int, 4> &cell) {
  std::array<Point, 4> vertices{};
  for (std::size_t i = 0; i < 3; ++i)
    vertices[i] = mesh.points[static_cast<std::size_t>(cell[i])];
  return aspect_ratio(2, vertices);
}

/// The first `count` of the nodes curve(0), curve(1/n), ...
Ring add_nodes(SerialMesh &mesh, int count, int n, const std::function<Point(double)> &curve) {
  Ring ring;
  for (int i = 0; i < count; ++i) {
    ring.push_back(static_cast<int>(mesh.points.size()));
    mesh.points.push_back(curve(static_cast<double>(i) / n));
  }
  return ring;
}

} // namespace

Ring add_closed_ring(SerialMesh &mesh, int n, const std::function<Point(double)> &curve) {
  Ring ring = add_nodes(mesh, n, n, curve);
  ring.push_back(ring.front());
  return ring;
}

Ring add_open_ring(SerialMesh &mesh, int n, const std::function<Point(double)> &curve) {
  return add_nodes(mesh, n + 1, n, curve);
}

void add_facets(SerialMesh &mesh, const std::string &boundary, const Ring &ring) {
  for (std::size_t i = 0; i + 1 < ring.size(); ++i)
    mesh.boundary[boundary].push_back({ring[i], ring[i + 1], -1});
}

void zip(SerialMesh &mesh, const Ring &left, const Ring &right) {
  constexpr double margin = 1e-8;
  const std::size_t m = left.size() - 1, n = right.size() - 1; // edges
  for (std::size_t i = 0, j = 0; i < m || j < n;) {
    std::array<int, 4> by_left{left[i], right[j], -1, -1}, by_right = by_left;
    if (i < m) by_left[2] = left[i + 1];
    if (j < n) by_right[2] = right[j + 1];
    const bool take_left =
        j == n || (i < m && quality(mesh, by_left) < (1 - margin) * quality(mesh, by_right));
    mesh.cells.push_back(take_left ? by_left : by_right);
    ++(take_left ? i : j);
  }
}

} // namespace rbvi
