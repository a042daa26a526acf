#include "rbvi/core/places.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rbvi::places_test {
namespace {

constexpr double pi = std::numbers::pi;

TEST(Places, BoxAndDiskAreNegativeInside) {
  const Place square = box({0, 0, 0}, {2, 1, 0}), round = disk({1, 2, 0}, 3);
  EXPECT_DOUBLE_EQ(square({0.3, 0.5, 0}), -0.3);
  EXPECT_DOUBLE_EQ(square({1, 0.9, 0}), 0.9 - 1);
  EXPECT_EQ(square({2, 0.5, 0}), 0);
  EXPECT_DOUBLE_EQ(square({5, 5, 0}), 5);
  EXPECT_DOUBLE_EQ(square({-2, 0.5, 0}), 2);
  EXPECT_DOUBLE_EQ(round({1, 2, 0}), -3);
  EXPECT_DOUBLE_EQ(round({5, 5, 0}), 2);
  EXPECT_DOUBLE_EQ(rim(round)({1, 2, 0}), 3);
  EXPECT_DOUBLE_EQ(rim(square)({-2, 0.5, 0}), 2);
}

TEST(Places, ACommonPartIsInBoth) {
  const Place quarter = common_part(disk({0, 0, 0}, 1), box({0, 0, 0}, {1, 1, 0}));
  EXPECT_LT(quarter({0.5, 0.5, 0}), 0);
  EXPECT_EQ(quarter({1, 0, 0}), 0);
  EXPECT_GT(quarter({0.9, 0.9, 0}), 0);
  EXPECT_DOUBLE_EQ(quarter({0.5, -0.1, 0}), 0.1);
}

TEST(Places, ASegmentEnds) {
  const Place line = segment({0, 1, 0}, {4, 1, 0});
  EXPECT_EQ(line({3, 1, 0}), 0);
  EXPECT_DOUBLE_EQ(line({1, -1, 0}), 2);
  EXPECT_DOUBLE_EQ(line({7, 5, 0}), 5);
  EXPECT_DOUBLE_EQ(line({-3, 5, 0}), 5);
}

TEST(Places, AnArcEnds) {
  const Place lowest = arc({0, 0, 0}, 2, -pi / 2, pi / 4);
  EXPECT_NEAR(lowest({0, -2, 0}), 0, 1e-15);
  EXPECT_NEAR(lowest({std::sqrt(2), -std::sqrt(2), 0}), 0, 1e-15);
  EXPECT_NEAR(lowest({0, -1.5, 0}), 0.5, 1e-15);
  const Point end{std::sqrt(2), -std::sqrt(2), 0};
  EXPECT_NEAR(lowest({2, 0, 0}), std::hypot(2 - end[0], end[1]), 1e-15);
  EXPECT_NEAR(lowest({-2, 0, 0}), std::hypot(2 - end[0], end[1]), 1e-15);
  const Place whole = arc({0, 0, 0}, 2, 0, pi);
  EXPECT_NEAR(whole({-3, 0, 0}), 1, 1e-15);
}

TEST(Places, TheNearestCounts) {
  const Place sides = nearest({segment({0, 0, 0}, {0, 1, 0}), segment({1, 0, 0}, {1, 1, 0})});
  EXPECT_DOUBLE_EQ(sides({0.25, 0.5, 0}), 0.25);
  EXPECT_DOUBLE_EQ(sides({0.875, 0.5, 0}), 0.125);
}

} // namespace
} // namespace rbvi::places_test
