// What is left of the conditions at an answer, and its scale.
#include "rbvi/method/residual.hpp"

#include "rbvi/core/error.hpp"

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

/// A u + B^T x = f and B u <= g of one function or several, rows of weight 1.
double residual(const Vector &au, const Vector &btx, const Vector &f, const Vector &bu,
                const Vector &g, const Vector &x, Index equations = 0) {
  const NodeLaws laws = uniform_laws(x.size(), 1, {});
  const Vector weights = Vector::Ones(x.size()), excess = bu - g;
  return residual_of({laws, weights, g, x, excess, 0, 0, equations},
                     {(au + btx - f).norm(), f.norm() + btx.norm()})
      .largest();
}

TEST(Residual, SeesEachConditionOfAPair) {
  const Vector one = Vector::Constant(1, 1), none = 0 * one, f = 2 * one;
  EXPECT_EQ(residual(one, one, f, one, one, one), 0);
  EXPECT_EQ(residual(one, none, f, one, one, one), 0.5);
  EXPECT_EQ(residual(one, one, f, 4 * one, 3 * one, none), 0.25);
  EXPECT_EQ(residual(one, one, f, 3 * one, 4 * one, one), 0.25);
  EXPECT_EQ(residual(none, none, none, none, none, none), 0);
  const Vector two = Vector::Ones(2);
  for (const Index entry : {0, 1}) {
    Vector bad = two;
    bad[entry] = nan;
    EXPECT_TRUE(std::isnan(residual(bad, -two, two, two, two, two)));
    EXPECT_TRUE(std::isnan(residual(two, -two, two, bad, two, two)));
    EXPECT_TRUE(std::isnan(residual(two, -two, two, two, bad, two)));
    EXPECT_TRUE(std::isnan(residual(two, -two, two, two, two, bad)));
  }
}

TEST(Residual, OfAnEquationSeesAnOpenGap) {
  const Vector one = Vector::Constant(1, 1), none = 0 * one, two = Vector::Constant(1, 2);
  // B u = 3 < 4 with x = 0: fine for a cone, no contact for a mode.
  EXPECT_EQ(residual(one, none, one, 3 * one, 4 * one, none), 0);
  EXPECT_EQ(residual(one, none, one, 3 * one, 4 * one, none, 1), 0.25);
  // The last rows alone are equations.
  const Vector bu{{0, 4}}, g{{1, 4}}, x{{0, -7}}, zero = Vector::Zero(2);
  EXPECT_EQ(residual(two, 0 * two, two, bu, g, x, 1), 0);
  EXPECT_EQ(residual(two, 0 * two, two, bu, g, x, 2), 0.25);
  EXPECT_EQ(residual(two, 0 * two, two, bu.reverse(), g.reverse(), zero, 1), 0.25);
  EXPECT_EQ(residual(two, 0 * two, two, g, g, x.reverse(), 1), 1) << "a pull";
}

/// A node that slips forwards under half its bound: the traction has the size of its bound or not.
TEST(Residual, OfLawsAloneSeesFriction) {
  const NodeLaws laws = uniform_laws(1, 2, {.coefficient = 0.5});
  const Vector g{{1, 0}}, slips{{0, -0.1}};
  EXPECT_EQ(residual_of_laws(laws, g, Vector{{2, 1}}, slips, 1), 0);
  EXPECT_GT(residual_of_laws(laws, g, Vector{{2, 0.5}}, slips, 1), 1e-3);
  EXPECT_GT(residual_of_laws(laws, g, Vector{{2, 1.5}}, slips, 1), 0.1);
  EXPECT_EQ(residual_of_laws(laws, g, Vector{{2, 0.5}}, Vector::Zero(2), 1), 0) << "sticks";
}

TEST(Residual, AboveItsLimitIsAFailureThatSaysWhatToTry) {
  EXPECT_NO_THROW(check_residual(1e-11, residual_limit, ": try this"));
  EXPECT_THROW(check_residual(nan, residual_limit, ": try this"), Error);
  EXPECT_THROW(check_residual(1e-9, residual_limit, ": try this"), Error);
  EXPECT_EQ(limit_of_iteration(1e-10, 1e-7), 1e-6);
  EXPECT_EQ(limit_of_iteration(1e-10, 1e-13), 1e-10);
}

} // namespace
} // namespace rbvi::residual_test
