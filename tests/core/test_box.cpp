#include "rbvi/core/box.hpp"

#include "rbvi/core/largest.hpp"

#include <gtest/gtest.h>

#include <set>

namespace rbvi::box_test {
namespace {

ParameterSpace space_of(int size) {
  std::vector<Parameter> parameters;
  for (int i = 0; i < size; ++i)
    parameters.push_back({"p" + std::to_string(i), "", double(i), 2.0 * i + 1, double(i), {}});
  return all_free(parameters);
}

Matrix columns(const std::vector<Mu> &set) {
  Matrix result(std::ssize(set.front()), std::ssize(set));
  for (Index k = 0; k < result.cols(); ++k)
    result.col(k) = Eigen::Map<const Vector>(set[k].data(), result.rows());
  return result;
}

TEST(Box, HasItsCornersAndTheCentresOfItsFaces) {
  for (const auto &[size, count] : {std::pair{1, 2}, {2, 8}, {3, 14}, {5, 42}, {6, 44}, {9, 50}}) {
    const ParameterSpace space = space_of(size);
    const std::vector<Mu> set = corners_and_faces(space);
    EXPECT_EQ(std::set<Mu>(set.begin(), set.end()).size(), static_cast<std::size_t>(count)) << size;
    for (const Mu &mu : set) {
      EXPECT_TRUE(in_box(space, mu));
      int bounds = 0;
      for (int i = 0; i < size; ++i) {
        const double value = mu[i];
        bounds += value == space.at(i).lower || value == space.at(i).upper ? 1 : 0;
      }
      EXPECT_TRUE(bounds == size || bounds == 1) << size << " " << bounds;
    }
  }
  EXPECT_EQ(corners_and_faces(space_of(2)),
            (std::vector<Mu>{{0, 1}, {1, 1}, {0, 3}, {1, 3}, {0, 2}, {1, 2}, {0.5, 1}, {0.5, 3}}));
}

/// No pair of parameters is seen at some of its four pairs of bounds only, up to 31 parameters.
TEST(Box, ManyParametersHaveCornersThatSeeEveryPairOfBounds) {
  const int size = 31;
  const ParameterSpace space = space_of(size);
  const std::vector<Mu> set = corners_and_faces(space);
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      std::map<std::pair<double, double>, int> count;
      for (std::size_t k = 0; k < 32; ++k)
        ++count[{set[k][i], set[k][j]}];
      ASSERT_EQ(count.size(), 4U) << i << " " << j;
      for (const auto &[pair, times] : count)
        EXPECT_EQ(times, 8) << i << " " << j;
    }
}

TEST(Box, SaysWhatIsNearerToItsBoundaryThanASet) {
  const ParameterSpace space = space_of(2); // [0, 1] x [1, 3]
  const Matrix middle = columns({{0.5, 2}});
  EXPECT_FALSE(nearer_to_boundary(space, middle, {0.5, 2}));
  EXPECT_TRUE(nearer_to_boundary(space, middle, {0.49, 2}));
  EXPECT_TRUE(nearer_to_boundary(space, middle, {0.5, 2.1}));
  std::vector<Mu> set = corners_and_faces(space);
  for (const Mu &mu : {Mu{0, 1}, {0.01, 2.99}, {1, 3}, {0.3, 1}})
    EXPECT_FALSE(nearer_to_boundary(space, columns(set), mu));
  std::erase(set, Mu{1, 3});
  EXPECT_TRUE(nearer_to_boundary(space, columns(set), {0.9, 2.8})); // 0.14 from that corner
  EXPECT_FALSE(nearer_to_boundary(space, columns(set), {0.1, 2.8}));
  set.push_back({0.95, 2.9});
  EXPECT_FALSE(nearer_to_boundary(space, columns(set), {0.9, 2.8}));
  EXPECT_TRUE(nearer_to_boundary(space, columns(set), {0.99, 2.99}));
}

TEST(Largest, IsNaNWhereOneIs) {
  const double nan = std::nan("");
  EXPECT_EQ(largest({1, 3, 2}), 3);
  EXPECT_EQ(largest({-1, -3}), -1);
  for (const auto &values : {std::array{nan, 1., 2.}, {1., nan, 2.}, {1., 2., nan}})
    EXPECT_TRUE(std::isnan(largest({values[0], values[1], values[2]})));
}

} // namespace
} // namespace rbvi::box_test
