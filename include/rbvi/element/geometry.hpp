// Geometry of one simplex and the geometric map h(mu).
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/scene.hpp"

namespace rbvi {

/// Volume and gradients of the barycentric (P1) functions of a simplex.
struct Simplex {
  double volume = 0;                     ///< negative if inverted
  Eigen::Matrix<double, 4, 3> gradients; ///< row i: gradient of barycentric function i
};

/// From dim + 1 vertices, dim = 2 or 3.
Simplex simplex(int dim, const std::array<Point, 4> &vertices);

/// The volume alone.
double volume_of(int dim, const std::array<Point, 4> &vertices);

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
