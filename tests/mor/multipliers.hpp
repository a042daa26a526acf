// Multipliers like those of an obstacle on a square grid, and what the tests of dual bases ask of
// them.
#pragma once

#include "rbvi/mor/cones.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi::testing_multipliers {

inline SparseMatrix sparse(const Matrix &dense) {
  return dense.sparseView();
}

inline SparseMatrix identity(Index n) {
  return sparse(Matrix::Identity(n, n));
}

/// Consistent mass of bilinear elements on a square grid: side^2 nodes on the unit square.
inline SparseMatrix grid_mass(Index side) {
  Matrix line = Matrix::Zero(side, side);
  for (Index i = 0; i + 1 < side; ++i) {
    line.block(i, i, 2, 2) += Matrix{{2, 1}, {1, 2}} / (6 * static_cast<double>(side - 1));
  }
  Matrix mass(side * side, side * side);
  for (Index i = 0; i < side; ++i)
    for (Index j = 0; j < side; ++j)
      mass.block(i * side, j * side, side, side) = line(i, j) * line;
  return sparse(mass);
}

/// Multipliers like those of an obstacle: bumps whose support grows and moves, exact zeros outside.
/// count^3 columns; `travel`: how far centres move, as a fraction of the square.
inline Matrix moving_bumps(Index side, int count, double travel) {
  Matrix result(side * side, count * count * count);
  Index p = 0;
  const auto at = [&](int k) { return count > 1 ? 2.0 * k / (count - 1) - 1 : 0.0; };
  for (int a = 0; a < count; ++a)
    for (int b = 0; b < count; ++b)
      for (int c = 0; c < count; ++c, ++p)
        for (Index i = 0; i < side * side; ++i) {
          const double radius = 0.32 + 0.04 * at(a);
          const double h = 1 / static_cast<double>(side - 1);
          const double x = static_cast<double>(i / side) * h - 0.5 - travel * at(b);
          const double y = static_cast<double>(i % side) * h - 0.5 - travel * at(c);
          result(i, p) = std::max(0.0, 1 - (x * x + y * y) / (radius * radius)) / radius;
        }
  return result;
}

inline double norm(const Vector &v, const SparseMatrix &product) {
  return std::sqrt(v.dot(Vector(product * v)));
}

/// The largest of distances_to_cone.
inline double largest_distance(const Matrix &values, const ConeBasis &basis,
                               const SparseMatrix &product) {
  return distances_to_cone(values, basis, product).maxCoeff();
}

} // namespace rbvi::testing_multipliers
