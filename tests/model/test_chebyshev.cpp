// Interpolation at Chebyshev points: exact for polynomials, exponential for smooth functions, and
// its own estimate of what it misses.
#include "rbvi/core/largest.hpp"
#include "rbvi/model/chebyshev.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::chebyshev_test {
namespace {

Scene two_parameters() {
  Scene scene;
  scene.parameters = all_free({{"x", "", -1, 2, 0}, {"y", "", 0.2, 5, 1}});
  const Coordinate logarithm{[](double y) { return std::log(y); },
                             [](double t) { return std::exp(t); }};
  scene.coordinates = {{1, logarithm}};
  return scene;
}

std::vector<ChebyshevAxis> axes(int x_points, int y_points) {
  return {{0, -1, 2, x_points}, {1, std::log(0.2), std::log(5), y_points}};
}

/// One row: the function at the grid points.
Matrix values_of(const Scene &scene, const std::vector<ChebyshevAxis> &grid,
                 double (*f)(double, double)) {
  const std::vector<FullMu> points = grid_points(scene, grid, {0, 1});
  Matrix values(1, static_cast<Index>(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k)
    values(0, static_cast<Index>(k)) = f(points[k][0], points[k][1]);
  return values;
}

double worst_error(const std::vector<ChebyshevAxis> &grid, double (*f)(double, double)) {
  const Scene scene = two_parameters();
  const Matrix values = values_of(scene, grid, f);
  double worst = 0;
  for (double x = -1; x <= 2; x += 0.17)
    for (double y = 0.2; y <= 5; y += 0.31)
      worst = larger(worst, std::abs((values * grid_weights(scene, grid, {x, y}))[0] - f(x, y)));
  return worst;
}

TEST(Chebyshev, PolynomialsInTheCoordinatesAreExact) {
  EXPECT_LE(worst_error(axes(4, 3),
                        [](double x, double y) {
                          const double t = std::log(y);
                          return (1 - x + 2 * x * x * x) * (3 + t - t * t);
                        }),
            1e-12);
}

TEST(Chebyshev, WeightsSumToOneAndAreThoseOfAPointAtThePoint) {
  const Scene scene = two_parameters();
  const auto grid = axes(5, 4);
  const std::vector<FullMu> points = grid_points(scene, grid, {0, 1});
  ASSERT_EQ(static_cast<Index>(points.size()), grid_size(grid));
  EXPECT_NEAR(grid_weights(scene, grid, {0.3, 1.7}).sum(), 1, 1e-14);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vector weights = grid_weights(scene, grid, points[k]);
    EXPECT_NEAR(weights[static_cast<Index>(k)], 1, 1e-9) << "point " << k;
  }
}

TEST(Chebyshev, SmoothFunctionsConvergeExponentiallyAndTheTailSaysHowFar) {
  const auto f = [](double x, double y) { return std::cos(x) / (1 + y); };
  double previous = 1;
  for (const int points : {5, 9, 17}) {
    const auto grid = axes(points, points);
    const double error = worst_error(grid, f);
    EXPECT_LE(error, std::max(1e-14, 0.05 * previous)) << points << " points";
    const double tail = chebyshev_tails(grid, values_of(two_parameters(), grid, f)).maxCoeff();
    EXPECT_GE(tail, 0.1 * error) << points << " points";
    EXPECT_LE(tail, 100 * error + 1e-14) << points << " points";
    previous = error;
  }
}

TEST(Chebyshev, EachAxisHasATailOfItsOwn) {
  const auto f = [](double x, double y) { return std::exp(x) * (1 + std::log(y)); };
  const auto grid = axes(5, 5);
  const Vector tails = chebyshev_tails(grid, values_of(two_parameters(), grid, f));
  EXPECT_GT(tails[0], 1e-6);
  EXPECT_LT(tails[1], 1e-14);
}

TEST(Chebyshev, NoAxisIsOnePointOfWeightOne) {
  const Scene scene = two_parameters();
  EXPECT_EQ(grid_size({}), 1);
  EXPECT_EQ(grid_points(scene, {}, {0.5, 2}), std::vector<FullMu>({{0.5, 2}}));
  EXPECT_EQ(grid_weights(scene, {}, {0.5, 2}), Vector::Ones(1));
  EXPECT_EQ(chebyshev_tails({}, Matrix::Ones(3, 1)).size(), 0);
}

} // namespace
} // namespace rbvi::chebyshev_test
