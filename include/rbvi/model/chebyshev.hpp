// Interpolation at Chebyshev points on a box: exponential convergence for what is smooth there.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/scene.hpp"

#include <vector>

namespace rbvi {

/// The coordinate of a parameter in which A^-1 varies smoothly, and back: that which a factor of
/// the scene's a gives it, else its logarithm where its range is wide and positive (A^-1 of a
/// modulus is singular at 0 and below), else itself.
double coordinate_at(const Scene &scene, int parameter, double value);
double value_back(const Scene &scene, int parameter, double coordinate);

/// One direction of the grid: `points` extremal Chebyshev points, from `upper` down to `lower`, in
/// the coordinate of the parameter. One point: the middle.
struct ChebyshevAxis {
  int parameter = 0;           ///< index into all parameters
  double lower = 0, upper = 0; ///< of the coordinate
  int points = 1;
};

/// Number of points of the product grid; 1 without an axis.
Index grid_size(const std::vector<ChebyshevAxis> &axes);

/// All parameters at each point of the grid, the last axis fastest; those without an axis as in
/// `all_parameters`.
std::vector<FullMu> grid_points(const Scene &scene, const std::vector<ChebyshevAxis> &axes,
                                const FullMu &all_parameters);

/// Weights of the values at the grid points, by the barycentric formula; they sum to 1.
Vector grid_weights(const Scene &scene, const std::vector<ChebyshevAxis> &axes,
                    const FullMu &all_parameters);

/// For each axis the size of the last two Chebyshev coefficients along it, relative to the largest
/// of all: what the interpolant still misses. `values`: entries x grid points.
Vector chebyshev_tails(const std::vector<ChebyshevAxis> &axes, const Matrix &values);

} // namespace rbvi
