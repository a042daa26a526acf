// What is left of the conditions at an answer, and its scale.
#include "rbvi/method/residual.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::residual_test {
namespace {

const double nan = std::nan("");

TEST(Residual, IsRelativeToWhatBalancesOrToAShareOfItsTerms) {
  EXPECT_EQ(relative({1e-12, 2, 0}), 5e-13);
  EXPECT_EQ(relative({0, 0, 0}), 0);
  // The round-off of terms that are 1e9 of what they balance, but nothing ten times as large.
  EXPECT_LE(relative({1e-7, 1, 1e9}), residual_limit);
  EXPECT_GT(relative({2e-6, 1, 1e9}), residual_limit);
  EXPECT_GT(relative({1e-9, 1, 1e3}), residual_limit);
}

TEST(Residual, OfNoNumberIsNone) {
  for (const Remainder &bad : {Remainder{nan, 1, 1}, Remainder{1, nan, 1}, Remainder{1, 1, nan}})
    EXPECT_FALSE(relative(bad) <= residual_limit);
  for (int k = 0; k < 5; ++k) {
    KktResidual kkt;
    double *const entries[]{&kkt.stationarity, &kkt.feasibility, &kkt.complementarity, &kkt.sign,
                            &kkt.friction};
    *entries[k] = nan;
    EXPECT_FALSE(kkt.largest() <= residual_limit) << k;
  }
}

/// Two nodes without friction, of which the first touches.
struct Rows {
  Vector g{{0.5, 1}}, lambda{{2, 0}}, excess{{0, -0.25}}, weights = Vector::Ones(2);
  double displacement = 0;
  KktResidual residual(Index equations = 0) const {
    const NodeLaws laws = uniform_laws(2, 1, {});
    return residual_of(sums_of({laws, weights, g, lambda, excess, displacement, 2, equations}),
                       false, {0, 1});
  }
};

TEST(Residual, SeesEachConditionOfContact) {
  EXPECT_EQ(Rows{}.residual().largest(), 0);
  Rows rows;
  rows.excess[1] = 0.1;
  EXPECT_DOUBLE_EQ(rows.residual().feasibility, 0.1 / 1.1);
  rows = {};
  rows.lambda[1] = -0.5;
  EXPECT_DOUBLE_EQ(rows.residual().sign, 0.25);
  EXPECT_GT(rows.residual().complementarity, 0.01);
  rows = {};
  rows.excess[0] = -1e-3;
  EXPECT_GT(rows.residual().complementarity, 1e-4);
  // The last row as an equation: its gap is open.
  EXPECT_DOUBLE_EQ(Rows{}.residual(1).feasibility, 0.25);
  for (double *const entry : {&rows.g[0], &rows.lambda[1], &rows.excess[1]}) {
    const double before = std::exchange(*entry, nan);
    EXPECT_FALSE(rows.residual().largest() <= residual_limit);
    *entry = before;
  }
}

/// Of a body that fills its box: B u and g are the round-off of what loads would move it by.
TEST(Residual, ZeroGapsAreSeenBesideWhatLoadsMove) {
  Rows rows;
  rows.g.setZero();
  rows.excess << 1e-17, -1e-17;
  EXPECT_EQ(rows.residual().feasibility, 1);
  rows.displacement = 1e-2;
  EXPECT_LE(rows.residual().largest(), 1e-11);
  rows.excess[0] = 1e-10;
  EXPECT_GT(rows.residual().feasibility, residual_limit);
}

} // namespace
} // namespace rbvi::residual_test
