#include "rings.hpp"

#include "rbvi/element/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

double quality(const SerialMesh &mesh, const std::array<int, 4> &cell) {
  std::array<Point, 4> vertices{};
  for (std::size_t i = 0; i < 3; ++i)
    vertices[i] = mesh.points[cell[i]];
  return aspect_ratio(2, vertices);
}

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The cost of a cell in a strip: a high power, for the worst cell to matter most; infinite if
/// inverted.
double cost_of(const SerialMesh &mesh, const std::array<int, 4> &cell) {
  const auto at = [&](int i) -> const Point & { return mesh.points[i]; };
  const Point &x = at(cell[0]), &y = at(cell[1]), &z = at(cell[2]);
  if ((y[0] - x[0]) * (z[1] - x[1]) <= (y[1] - x[1]) * (z[0] - x[0])) return infinity;
  return std::pow(quality(mesh, cell), 8);
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

void zip_best(SerialMesh &mesh, const Ring &left, const Ring &right) {
  constexpr double margin = 1e-8;
  const std::size_t m = left.size(), n = right.size();
  const auto cost = [&](std::size_t i, std::size_t j, int third) {
    return cost_of(mesh, {left[i], right[j], third, -1});
  };
  // The cost of the best triangulation up to the edge from left[i] to right[j], and its last step.
  std::vector<double> sum(n, 0);
  std::vector<bool> by_left(m * n, false);
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      if (i + j == 0) continue;
      const double with_left = i > 0 ? sum[j] + cost(i - 1, j, left[i]) : infinity;
      const double with_right = j > 0 ? sum[j - 1] + cost(i, j - 1, right[j]) : infinity;
      by_left[i * n + j] = with_left < (1 - margin) * with_right;
      sum[j] = by_left[i * n + j] ? with_left : with_right;
    }
  const std::size_t first = mesh.cells.size();
  for (std::size_t i = m - 1, j = n - 1; i + j > 0;) {
    const bool step = by_left[i * n + j];
    const int third = step ? left[i--] : right[j--];
    mesh.cells.push_back({left[i], right[j], third, -1});
  }
  std::reverse(mesh.cells.begin() + static_cast<std::ptrdiff_t>(first), mesh.cells.end());
}

} // namespace rbvi
