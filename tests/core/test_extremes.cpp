#include "rbvi/core/extremes.hpp"

#include <gtest/gtest.h>

#include <set>

namespace rbvi::extremes_test {
namespace {

ParameterSpace box(int size) {
  std::vector<Parameter> parameters;
  for (int i = 0; i < size; ++i)
    parameters.push_back({"p" + std::to_string(i), "", -1.0 - i, 1.0 + i, 0});
  return all_free(parameters);
}

TEST(ExtremesOfBox, AreItsCornersAndTheCentresOfItsFaces) {
  EXPECT_EQ(extremes_of_box(box(1)), (std::vector<Mu>{{-1}, {1}}));
  EXPECT_EQ(
      extremes_of_box(box(2)),
      (std::vector<Mu>{{-1, -2}, {1, -2}, {-1, 2}, {1, 2}, {-1, 0}, {1, 0}, {0, -2}, {0, 2}}));
}

/// 32 different corners, each parameter at either end in half of them.
TEST(ExtremesOfBox, AreFewOfManyParameters) {
  for (const int size : {5, 6, 8, 11}) {
    const std::vector<Mu> set = extremes_of_box(box(size));
    ASSERT_EQ(set.size(), 32U + 2U * static_cast<unsigned>(size));
    EXPECT_EQ(std::set<Mu>(set.begin(), set.end()).size(), set.size());
    for (std::size_t i = 0; i < static_cast<std::size_t>(size); ++i) {
      int up = 0;
      for (std::size_t k = 0; k < 32; ++k) {
        EXPECT_EQ(std::abs(set[k][i]), 1.0 + static_cast<double>(i));
        up += set[k][i] > 0 ? 1 : 0;
      }
      EXPECT_EQ(up, 16);
    }
  }
}

} // namespace
} // namespace rbvi::extremes_test
