#include "../../src/method/pivoting.hpp"
#include "rbvi/core/error.hpp"

#include <gtest/gtest.h>

namespace rbvi::pivoting_test {
using namespace rbvi::pivoting;

namespace {

using Entries = std::vector<Index>;

/// Negative entries are violated beyond their own scale alone.
TEST(Pivoting, ViolationsOfBothKindsInOrder) {
  BasicSolution basic{.active = {1, 3}, .x = Vector(2), .w = Vector(5), .violated = {4}};
  basic.x << 2, -1;
  basic.w << -1, 0, -1e-15, 0, 3;
  find_violations(basic, basic.x, Vector::Ones(5), 1e-13);
  EXPECT_EQ(basic.violated, (Entries{0, 3}));
  find_violations(basic, basic.x, 1e14 * Vector::Ones(5), 1e-13);
  EXPECT_EQ(basic.violated, (Entries{3}));
}

TEST(Pivoting, AnExchangeIsItsOwnInverse) {
  const Entries active{0, 2, 5}, which{1, 2};
  EXPECT_EQ(exchanged(active, which), (Entries{0, 1, 5}));
  EXPECT_EQ(exchanged(exchanged(active, which), which), active);
}

TEST(Pivoting, AGuessIsSortedAndItsEntriesExist) {
  EXPECT_EQ(checked_guess({3, 0, 3}, 4), (Entries{0, 3}));
  EXPECT_THROW(checked_guess({4}, 4), Error);
  EXPECT_THROW(checked_guess({-1}, 4), Error);
}

TEST(Pivoting, BlocksWhileTheViolationFalls) {
  Policy<int, int> policy(2);
  for (int violation = 9; violation > 0; --violation)
    EXPECT_EQ(policy.after(violation, violation), Exchange::block);
  EXPECT_EQ(policy.least(), 1);
}

TEST(Pivoting, ABasisThatReturnsEndsTheBlocks) {
  Policy<int, int> policy(100);
  EXPECT_EQ(policy.after(1, 5), Exchange::block);
  EXPECT_EQ(policy.after(2, 6), Exchange::block);
  EXPECT_EQ(policy.after(1, 5), Exchange::fallback);
  EXPECT_EQ(policy.after(3, 5), Exchange::fallback);
  EXPECT_EQ(policy.after(4, 4), Exchange::block) << "a new least violation brings blocks back";
}

TEST(Pivoting, PatienceEnds) {
  Policy<int, double> policy(3);
  EXPECT_FALSE(policy.is_lost(1.0));
  EXPECT_FALSE(policy.is_lost(1.0));
  EXPECT_FALSE(policy.is_lost(2.0));
  EXPECT_TRUE(policy.is_lost(1.0));
  EXPECT_FALSE(policy.is_lost(0.5));
  policy.restart();
  EXPECT_FALSE(policy.is_lost(7.0)) << "a new run has a least violation of its own";
}

TEST(Pivoting, VisitsOutliveARestart) {
  Policy<int, double> policy(3);
  EXPECT_FALSE(policy.returns(1));
  policy.restart();
  EXPECT_TRUE(policy.returns(1));
  EXPECT_FALSE(policy.returns(2));
}

} // namespace

} // namespace rbvi::pivoting_test
