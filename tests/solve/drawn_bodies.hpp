// Bodies drawn by grids of triangles at any place and angle, and scenes on them from the text of a
// case.
#pragma once

#include "rbvi/scene/case.hpp"
#include "rbvi/solve/high_fidelity.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

namespace rbvi {

/// Turned counterclockwise about the origin.
inline Point turned_by(double angle, const Point &x) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * x[0] - s * x[1], s * x[0] + c * x[1], 0};
}

/// Adds the image of a grid of nx x ny squares on (0, 1)^2, each of two triangles. `sides`: the
/// boundaries below, on the right, above and on the left; "": none. `around`: the right side is the
/// left one.
inline void add_grid(SerialMesh &mesh, int nx, int ny,
                     const std::function<Point(const Point &)> &at,
                     const std::array<std::string, 4> &sides, bool around = false) {
  const auto first = static_cast<int>(mesh.points.size());
  const int columns = around ? nx : nx + 1;
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i < columns; ++i)
      mesh.points.push_back(at({1.0 * i / nx, 1.0 * j / ny, 0}));
  const auto node = [&](int i, int j) { return first + j * columns + i % columns; };
  const auto edge = [&](std::size_t side, int a, int b) {
    if (!sides[side].empty()) mesh.boundary[sides[side]].push_back({a, b, -1});
  };
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      mesh.cells.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1), -1});
      mesh.cells.push_back({node(i, j), node(i + 1, j + 1), node(i, j + 1), -1});
    }
  for (int i = 0; i < nx; ++i) {
    edge(0, node(i, 0), node(i + 1, 0));
    edge(2, node(i + 1, ny), node(i, ny));
  }
  for (int j = 0; j < ny && !around; ++j) {
    edge(1, node(nx, j), node(nx, j + 1));
    edge(3, node(0, j + 1), node(0, j));
  }
}

/// A scene on a drawing: the options of Problem that hand it over.
struct Drawn {
  Scene scene;
  MeshOptions mesh;
};

inline Drawn drawn(const std::string &text, const SerialMesh &mesh, int degree = 1) {
  const SceneEntry entry =
      read_case("rbvi: 1\nphysics: plane_strain\nmesh: {file: drawing.msh, degree: " +
                    std::to_string(degree) + "}\n" + text,
                "drawing.yaml");
  return {make_scene(entry), {"", 0, std::make_shared<const std::vector<SerialMesh>>(1, mesh)}};
}

inline HfSolution solve(const Drawn &of, const Mu &mu, const HfOptions &options = {}) {
  Problem problem(PETSC_COMM_WORLD, of.scene, of.mesh);
  return HighFidelity(problem, options).solve(mu);
}

} // namespace rbvi
