// Interpolation on sparse grids: exact for the polynomials that the points are of, exponential for
// smooth functions.
#include "rbvi/core/largest.hpp"
#include "rbvi/model/sparse_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::sparse_grid_test {
namespace {

Scene two_parameters() {
  Scene scene;
  scene.parameters = all_free({{"x", "", -1, 2, 0}, {"y", "", 0.2, 5, 1}});
  const Coordinate logarithm{[](double y) { return std::log(y); },
                             [](double t) { return std::exp(t); }};
  scene.coordinates = {{1, logarithm}};
  return scene;
}

/// All points of at most this degree in both coordinates together, or in each.
SparseGrid grid_of(int degree, bool in_each = false) {
  SparseGrid grid{{{0, -1, 2}, {1, std::log(0.2), std::log(5)}}, leja_points(degree + 1), {}};
  for (int i = 0; i <= degree; ++i)
    for (int k = 0; k <= (in_each ? degree : degree - i); ++k)
      grid.append({i, k});
  return grid;
}

/// The coefficients of the interpolant, point by point.
Vector coefficients_of(const Scene &scene, const SparseGrid &grid, double (*f)(double, double)) {
  Vector coefficients = Vector::Zero(grid.size());
  for (Index p = 0; p < grid.size(); ++p) {
    const FullMu at = parameters_at(
        scene, grid, {grid.points[std::size_t(2 * p)], grid.points[std::size_t(2 * p + 1)]},
        {0, 1});
    coefficients[p] = f(at[0], at[1]) - coefficients.dot(grid_functions(scene, grid, at));
  }
  return coefficients;
}

double worst_error(const SparseGrid &grid, double (*f)(double, double)) {
  const Scene scene = two_parameters();
  const Vector coefficients = coefficients_of(scene, grid, f);
  double worst = 0;
  for (double x = -1; x <= 2; x += 0.17)
    for (double y = 0.2; y <= 5; y += 0.31)
      worst =
          larger(worst, std::abs(coefficients.dot(grid_functions(scene, grid, {x, y})) - f(x, y)));
  return worst;
}

TEST(SparseGrid, PolynomialsInTheCoordinatesAreExact) {
  EXPECT_LE(worst_error(grid_of(3),
                        [](double x, double y) {
                          const double t = std::log(y);
                          return 1 - x + 2 * x * x * x + x * t - 3 * x * t * t + t * t * t;
                        }),
            1e-12);
}

TEST(SparseGrid, AFunctionIsOneAtItsPointAndZeroAtThoseBefore) {
  const Scene scene = two_parameters();
  const SparseGrid grid = grid_of(6, true);
  for (Index p = 0; p < grid.size(); ++p) {
    const GridPoint point{grid.points[std::size_t(2 * p)], grid.points[std::size_t(2 * p + 1)]};
    const Vector functions = grid_functions(scene, grid, parameters_at(scene, grid, point, {0, 1}));
    EXPECT_NEAR(functions[p], 1, 1e-12) << "point " << p;
    EXPECT_LE(functions.head(p).cwiseAbs().maxCoeff(), 1.01) << "point " << p;
    for (Index q = 0; q < grid.size(); ++q)
      if (grid.points[std::size_t(2 * q)] > point[0] ||
          grid.points[std::size_t(2 * q + 1)] > point[1])
        EXPECT_NEAR(functions[q], 0, 1e-12) << "points " << p << ", " << q;
  }
}

TEST(SparseGrid, FunctionsAreAboutOneAtMost) {
  const Scene scene = two_parameters();
  const SparseGrid grid = grid_of(32);
  for (double x = -1; x <= 2; x += 0.0371)
    EXPECT_LE(grid_functions(scene, grid, {x, 1.3}).cwiseAbs().maxCoeff(), 1.01) << x;
}

TEST(SparseGrid, SmoothFunctionsConvergeExponentially) {
  const auto f = [](double x, double y) { return std::cos(x) / (1 + y); };
  double previous = 1;
  for (const int degree : {4, 8, 16}) {
    const double error = worst_error(grid_of(degree), f);
    EXPECT_LE(error, std::max(1e-14, 0.05 * previous)) << degree;
    previous = error;
  }
}

TEST(SparseGrid, NoAxisIsOnePointWhoseFunctionIsOne) {
  const Scene scene = two_parameters();
  const SparseGrid none{{}, leja_points(1), {}};
  EXPECT_EQ(none.size(), 1);
  EXPECT_EQ(grid_functions(scene, none, {0.5, 2}), Vector::Ones(1));
  EXPECT_EQ(parameters_at(scene, none, {}, {0.5, 2}), (FullMu{0.5, 2}));
}

} // namespace
} // namespace rbvi::sparse_grid_test
