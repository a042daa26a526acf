// Interpolation on a sparse grid over some of the parameters: exponential convergence for what is
// smooth there, by as few points as the accuracy wants. Points are Leja's along each axis, which
// are nested, and what a point adds is the coefficient of its own function (Chkifa, Cohen and
// Schwab 2014).
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/scene.hpp"

#include <limits>
#include <vector>

namespace rbvi {

/// The coordinate of a parameter in which A^-1 varies smoothly, and back: that which a factor of
/// the scene's a gives it, else its logarithm where its range is wide and positive (A^-1 of a
/// modulus is singular at 0 and below), else itself.
double coordinate_at(const Scene &scene, int parameter, double value);
double value_back(const Scene &scene, int parameter, double coordinate);

struct GridAxis {
  int parameter = 0;           ///< index into all parameters
  double lower = 0, upper = 0; ///< of its coordinate, which the abscissae take as -1 and 1
  int most = std::numeric_limits<int>::max(); ///< points along it: a choice has no others
};

/// Of a parameter. A choice has Leja points for its values, which it is exact at.
GridAxis axis_of(const Scene &scene, int parameter);

/// The number of the abscissa along each axis.
using GridPoint = std::vector<int>;

struct SparseGrid {
  std::vector<GridAxis> axes;
  Vector abscissae;        ///< of all axes
  std::vector<int> points; ///< the numbers of each GridPoint, one point after the other

  Index size() const; ///< points; 1 without an axis
  void append(const GridPoint &point);
};

/// On [-1, 1] from the middle on: each the farthest from those before, by the product of the
/// distances. The first n are good points of interpolation for every n.
Vector leja_points(int count);

/// All parameters at a point, those without an axis as in `all_parameters`.
FullMu parameters_at(const Scene &scene, const SparseGrid &grid, const GridPoint &point,
                     const FullMu &all_parameters);

/// The function of each point: the product over the axes of the polynomial in x, of degree k where
/// the point has abscissa k, that is 1 there and 0 at the k abscissae before it; about 1 at most.
Vector grid_functions(const Scene &scene, const SparseGrid &grid, const FullMu &all_parameters);

} // namespace rbvi
