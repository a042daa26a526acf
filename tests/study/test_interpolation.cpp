#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/study/interpolation.hpp"

#include <gtest/gtest.h>

namespace rbvi::interpolation_test {

namespace {

const ParameterSpace space =
    all_free({{"a", "", 0, 2, 1}, {"b", "", -1, 1, 0}, {"c", "", 3, 4, 3}});

/// Multilinear, so that interpolation reproduces it, beyond the ends too.
double multilinear(const Mu &mu) {
  return 1 + 2 * mu[0] - mu[1] + 3 * mu[0] * mu[1] - mu[0] * mu[1] * mu[2];
}

double interpolated(const TrainingGrid &grid, const std::vector<Mu> &set, const Mu &mu) {
  double sum = 0;
  for (const auto &[number, weight] : interpolation_weights(grid, set, space, mu))
    sum += weight * multilinear(set.at(number));
  return sum;
}

} // namespace

TEST(Interpolation, ReproducesMultilinearFunctionsOnAGrid) {
  const std::vector<Mu> set = parse_set(space, "grid:3,2,4");
  const TrainingGrid grid = find_grid(set);
  ASSERT_EQ(grid.ticks.size(), 3u);
  for (const Mu &mu : parse_set(space, "random:50:1"))
    EXPECT_NEAR(interpolated(grid, set, mu), multilinear(mu), 1e-12);
  for (const Mu &mu : set)
    EXPECT_NEAR(interpolated(grid, set, mu), multilinear(mu), 1e-12);
  EXPECT_NEAR(interpolated(grid, set, {2.5, -1.5, 4.2}), multilinear({2.5, -1.5, 4.2}), 1e-12);
}

TEST(Interpolation, AcceptsAGridOfOneValue) {
  const std::vector<Mu> set = parse_set(space, "grid:3,1,2");
  const TrainingGrid grid = find_grid(set);
  ASSERT_EQ(grid.ticks.size(), 3u);
  EXPECT_NEAR(interpolated(grid, set, {0.3, 0.9, 3.7}), multilinear({0.3, 0, 3.7}), 1e-12);
}

TEST(Interpolation, TakesTheNearestSampleWhereThereIsNoGrid) {
  std::vector<Mu> set = parse_set(space, "grid:3,2,4");
  set.erase(set.begin() + 5);
  const TrainingGrid grid = find_grid(set);
  EXPECT_TRUE(grid.ticks.empty());
  const auto weights = interpolation_weights(grid, set, space, {1.9, 0.9, 3.05});
  ASSERT_EQ(weights.size(), 1u);
  EXPECT_EQ(set.at(weights.front().first), (Mu{2, 1, 3}));
  EXPECT_EQ(weights.front().second, 1.0);
}

} // namespace rbvi::interpolation_test
