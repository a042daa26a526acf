// What the tests of the built-in meshes ask of a mesh of triangles: areas, shapes, edges, names.
#pragma once

#include "rbvi/element/geometry.hpp"
#include "rbvi/mesh/serial.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace rbvi {

inline std::size_t at(PetscInt i) {
  return static_cast<std::size_t>(i);
}

inline double length(const Point &x, const Point &y) {
  return std::hypot(x[0] - y[0], x[1] - y[1]);
}

/// Area of the regular polygon with its corners on the circle.
inline double polygon_area(int sides, double radius) {
  return 0.5 * sides * radius * radius * std::sin(2 * std::numbers::pi / sides);
}

inline std::array<Point, 4> corners(const SerialMesh &mesh, int cell) {
  std::array<Point, 4> points{};
  for (std::size_t i = 0; i < 3; ++i)
    points[i] = mesh.points[mesh.cells[cell][i]];
  return points;
}

inline std::vector<int> all_cells(const SerialMesh &mesh) {
  std::vector<int> cells;
  for (int c = 0; c < static_cast<int>(mesh.cells.size()); ++c)
    cells.push_back(c);
  return cells;
}

inline double area(const SerialMesh &mesh, const std::vector<int> &cells) {
  double sum = 0;
  for (const int cell : cells)
    sum += simplex(2, corners(mesh, cell)).volume;
  return sum;
}

inline double worst_aspect_ratio(const SerialMesh &mesh) {
  double worst = 0;
  for (const int cell : all_cells(mesh))
    worst = std::max(worst, aspect_ratio(2, corners(mesh, cell)));
  return worst;
}

using Edge = std::pair<int, int>;

inline Edge sorted(int a, int b) {
  return {std::min(a, b), std::max(a, b)};
}

inline std::map<Edge, std::vector<int>> cells_of_edges(const SerialMesh &mesh) {
  std::map<Edge, std::vector<int>> found;
  for (const int c : all_cells(mesh))
    for (std::size_t i = 0; i < 3; ++i)
      found[sorted(mesh.cells[c][i], mesh.cells[c][(i + 1) % 3])].push_back(c);
  return found;
}

/// The lengths of the shortest and the longest edge.
inline std::pair<double, double> range_of_edges(const SerialMesh &mesh) {
  std::set<double> lengths;
  for (const auto &[edge, neighbours] : cells_of_edges(mesh))
    lengths.insert(length(mesh.points[edge.first], mesh.points[edge.second]));
  return {*lengths.begin(), *lengths.rbegin()};
}

/// The largest ratio of the areas of two cells that share an edge.
inline double largest_jump(const SerialMesh &mesh) {
  double jump = 0;
  for (const auto &[edge, neighbours] : cells_of_edges(mesh)) {
    if (neighbours.size() != 2) continue;
    const double a = area(mesh, {neighbours[0]}), b = area(mesh, {neighbours[1]});
    jump = std::max({jump, a / b, b / a});
  }
  return jump;
}

/// Nodes of a boundary by increasing x, then y.
inline std::vector<int> nodes_of(const SerialMesh &mesh, const std::string &boundary) {
  std::set<int> numbers;
  for (const auto &facet : mesh.boundary.at(boundary))
    numbers.insert(facet.begin(), facet.begin() + 2);
  std::vector<int> ordered(numbers.begin(), numbers.end());
  std::sort(ordered.begin(), ordered.end(),
            [&](int a, int b) { return mesh.points[a] < mesh.points[b]; });
  return ordered;
}

inline std::vector<Point> points_of(const SerialMesh &mesh, const std::string &boundary) {
  std::vector<Point> points;
  for (const int v : nodes_of(mesh, boundary))
    points.push_back(mesh.points[v]);
  return points;
}

/// Every facet of one cell alone is once in each boundary that `expected` names, and in no other;
/// no other facet is in a boundary.
template <class Expected> void expect_boundaries(const SerialMesh &mesh, Expected &&expected) {
  std::map<Edge, std::multiset<std::string>> names;
  for (const auto &[name, facets] : mesh.boundary)
    for (const auto &facet : facets)
      names[sorted(facet[0], facet[1])].insert(name);
  std::size_t outer = 0;
  for (const auto &[edge, neighbours] : cells_of_edges(mesh)) {
    if (neighbours.size() != 1) continue;
    ++outer;
    const Point &x = mesh.points[edge.first], &y = mesh.points[edge.second];
    EXPECT_EQ(names[edge], expected(x, y)) << x[0] << " " << x[1] << ", " << y[0] << " " << y[1];
  }
  EXPECT_EQ(names.size(), outer);
}

} // namespace rbvi
