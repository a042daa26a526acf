// Geometry of one simplex and the geometric map h(mu).
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/scene.hpp"

#include <numbers>

namespace rbvi {

/// The point of the simplex of the first `count` vertices with these barycentric coordinates.
inline Point point_at(const std::array<Point, 4> &vertices,
                      const std::array<double, 4> &barycentric, int count) {
  Point x{};
  for (int i = 0; i < count; ++i)
    x = x + barycentric[i] * vertices[i];
  return x;
}

/// Volume and gradients of the barycentric (P1) functions of a simplex.
struct Simplex {
  double volume = 0;                     ///< negative if inverted
  Eigen::Matrix<double, 4, 3> gradients; ///< row i: gradient of barycentric function i
};

/// From dim + 1 vertices, dim = 2 or 3.
Simplex simplex(int dim, const std::array<Point, 4> &vertices);

/// Coordinates of a point: of the vertices of the simplex at it.
std::array<double, 4> barycentric_of(int dim, const std::array<Point, 4> &vertices, const Point &x);

/// The volume alone.
double volume_of(int dim, const std::array<Point, 4> &vertices);

/// What integrals over a plane domain are weighted by at a point of it: 1, of a body that is turned
/// about x = 0 the length of the circle on which the point lies.
inline double circumference(bool axisymmetric, const Point &x) {
  return axisymmetric ? 2 * std::numbers::pi * x[0] : 1;
}

/// Mean of the reference vertices.
Point reference_centre(const Cell &cell);

/// Throws failure, naming mu, if the mapped simplex is inverted or degenerate (volume <= 1e-12
/// times its longest edge to the power dim).
void check_orientation(const Scene &scene, const FullMu &mu, const Cell &cell);

/// Fills Cell::mapped by h(mu) and checks its orientation.
void map_cell(const Scene &scene, const FullMu &mu, Cell &cell);

/// Longest edge over inradius, scaled to 1 for the regular simplex; dim = 2 or 3.
double aspect_ratio(int dim, const std::array<Point, 4> &vertices);

} // namespace rbvi
