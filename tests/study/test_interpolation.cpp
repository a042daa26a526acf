#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/study/interpolation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace rbvi::interpolation_test {

namespace {

const ParameterSpace space =
    all_free({{"a", "", 0, 2, 1}, {"b", "", -1, 1, 0}, {"c", "", 3, 4, 3}});

/// Multilinear, so that interpolation reproduces it, beyond the ends too.
double multilinear(const Mu &mu) {
  return 1 + 2 * mu[0] - mu[1] + 3 * mu[0] * mu[1] - mu[0] * mu[1] * mu[2];
}

double interpolated(const SampleInterpolation &samples, const std::vector<Mu> &set, const Mu &mu,
                    double (*function)(const Mu &mu) = multilinear) {
  double sum = 0;
  for (const auto &[number, weight] : samples.weights(mu))
    sum += weight * function(set.at(number));
  return sum;
}

} // namespace

TEST(Interpolation, ReproducesMultilinearFunctionsOnAGrid) {
  const std::vector<Mu> set = parse_set(space, "grid:3,2,4");
  const SampleInterpolation grid(space, set);
  ASSERT_TRUE(grid.on_grid());
  for (const Mu &mu : parse_set(space, "random:50:1"))
    EXPECT_NEAR(interpolated(grid, set, mu), multilinear(mu), 1e-12);
  for (const Mu &mu : set)
    EXPECT_NEAR(interpolated(grid, set, mu), multilinear(mu), 1e-12);
  EXPECT_NEAR(interpolated(grid, set, {2.5, -1.5, 4.2}), multilinear({2.5, -1.5, 4.2}), 1e-12);
}

TEST(Interpolation, AcceptsAGridOfOneValue) {
  const std::vector<Mu> set = parse_set(space, "grid:3,1,2");
  const SampleInterpolation grid(space, set);
  ASSERT_TRUE(grid.on_grid());
  EXPECT_NEAR(interpolated(grid, set, {0.3, 0.9, 3.7}), multilinear({0.3, 0, 3.7}), 1e-12);
}

double smooth(const Mu &mu) {
  return std::exp(mu[0] / 2) * std::cos(mu[1]) + mu[2] * mu[2];
}

TEST(Interpolation, OfScatteredSamplesIsExactAtThemAndForLinearFunctions) {
  const std::vector<Mu> set = parse_set(space, "random:60:1"),
                        unseen = parse_set(space, "random:50:2");
  const SampleInterpolation samples(space, set);
  ASSERT_FALSE(samples.on_grid());
  const auto linear = [](const Mu &mu) { return 1 + 2 * mu[0] - mu[1] + 3 * mu[2]; };
  double worst = 0, nearest = 0;
  for (const Mu &mu : unseen) {
    EXPECT_NEAR(interpolated(samples, set, mu, linear), linear(mu), 1e-11);
    worst = std::max(worst, std::abs(interpolated(samples, set, mu, smooth) - smooth(mu)));
    const auto distance = [&](const Mu &other) {
      return std::hypot((mu[0] - other[0]) / 2, (mu[1] - other[1]) / 2, mu[2] - other[2]);
    };
    const Mu &closest = *std::min_element(set.begin(), set.end(), [&](const Mu &a, const Mu &b) {
      return distance(a) < distance(b);
    });
    nearest = std::max(nearest, std::abs(smooth(closest) - smooth(mu)));
  }
  for (const Mu &mu : set)
    EXPECT_NEAR(interpolated(samples, set, mu, smooth), smooth(mu), 1e-10);
  EXPECT_LE(worst, nearest / 5);
}

TEST(Interpolation, TakesSamplesThatRepeatOrLieInAPlane) {
  std::vector<Mu> set = parse_set(space, "random:9:1");
  for (Mu &mu : set)
    mu[1] = 0.5;
  set.push_back(set.front());
  const SampleInterpolation samples(space, set);
  for (const Mu &mu : set)
    EXPECT_NEAR(interpolated(samples, set, mu, smooth), smooth(mu), 1e-9);
}

} // namespace rbvi::interpolation_test
