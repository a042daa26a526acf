#include "random_matrix.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/method/mixed_qp.hpp"

#include <gtest/gtest.h>

namespace rbvi::mixed_qp_test {

namespace {

double objective(const Matrix &y, const Vector &c, const Vector &g, const Vector &x) {
  return 0.5 * (y * x - c).squaredNorm() + g.dot(x);
}

/// Independent of the elimination: every free variable is the difference of two that are >= 0.
double split_objective(const Matrix &y, const Vector &c, const Vector &g, Index free) {
  Matrix columns(y.rows(), y.cols() + free);
  columns << y, -y.rightCols(free);
  Vector linear(columns.cols());
  linear << g, -g.tail(free);
  NonnegativeQp qp(y.rows());
  EXPECT_TRUE(qp.solve(columns, c, linear).converged);
  return objective(columns, c, linear, qp.x());
}

/// Stationary in the free variables, optimal in the others; relative to the terms of each row.
void expect_optimal(const Matrix &y, const Vector &c, const Vector &g, Index free,
                    const MixedQp &qp) {
  const Vector gradient = g - y.transpose() * qp.residual();
  EXPECT_LT((c - y * qp.x() - qp.residual()).norm(), 1e-12 * c.norm());
  for (Index j = 0; j < y.cols(); ++j) {
    const double scale = y.col(j).norm() * c.norm() + std::abs(g[j]);
    if (j >= y.cols() - free || qp.x()[j] > 0) {
      EXPECT_NEAR(gradient[j], 0, 1e-11 * scale) << j;
    } else {
      EXPECT_GE(gradient[j], -1e-11 * scale) << j;
      EXPECT_EQ(qp.x()[j], 0) << j;
    }
  }
}

} // namespace

TEST(MixedQp, IsTheMinimum) {
  Random random(3);
  for (const Index free : {Index(0), Index(1), Index(4), Index(9)}) {
    const Matrix y = random.matrix(12, 9);
    const Vector g = random.vector(9);
    MixedQp qp(12, free);
    for (int query = 0; query < 5; ++query) { // the factorisation is kept, c changes
      const Vector c = random.vector(12);
      ASSERT_TRUE(qp.solve(y, c, g).converged);
      expect_optimal(y, c, g, free, qp);
      EXPECT_NEAR(objective(y, c, g, qp.x()), split_objective(y, c, g, free), 1e-11);
    }
  }
}

TEST(MixedQp, FollowsNewColumnsAfterReset) {
  Random random(4);
  MixedQp qp(10, 3);
  for (int query = 0; query < 5; ++query) {
    const Matrix y = random.matrix(10, 8);
    const Vector c = random.vector(10), g = random.vector(8);
    qp.reset();
    ASSERT_TRUE(qp.solve(y, c, g).converged);
    expect_optimal(y, c, g, 3, qp);
  }
}

TEST(MixedQp, LeavesOutDependentFreeColumns) {
  Random random(5);
  Matrix y = random.matrix(10, 6);
  y.col(5) = 2 * y.col(4) - y.col(3);
  const Vector c = random.vector(10);
  Vector g = random.vector(6);
  g[5] = 2 * g[4] - g[3]; // consistent
  MixedQp qp(10, 3);
  ASSERT_TRUE(qp.solve(y, c, g).converged);
  expect_optimal(y, c, g, 3, qp);
  g[5] += 1; // along the dependent direction the objective falls without end
  qp.reset();
  EXPECT_TRUE(qp.solve(y, c, g).unbounded);
}

TEST(MixedQp, ABoundedColumnInTheSpanOfTheFreeOnesIsNoDirection) {
  Random random(6);
  Matrix y = random.matrix(10, 6);
  y.col(1) = 0.3 * y.col(4) - 2 * y.col(5);
  const Vector c = random.vector(10);
  MixedQp projection(10, 2);
  ASSERT_TRUE(projection.solve(y, c).converged);
  expect_optimal(y, c, Vector::Zero(6), 2, projection);
  Vector g = random.vector(6);
  g[1] = 0.3 * g[4] - 2 * g[5]; // along it the objective is constant
  MixedQp qp(10, 2);
  ASSERT_TRUE(qp.solve(y, c, g).converged);
  expect_optimal(y, c, g, 2, qp);
}

TEST(MixedQp, ChecksItsSizes) {
  MixedQp qp(3, 2);
  EXPECT_THROW(qp.solve(Matrix::Identity(3, 1), Vector::Ones(3)), Error);
  EXPECT_THROW(qp.solve(Matrix::Identity(3, 3), Vector::Ones(2)), Error);
  EXPECT_THROW(qp.solve(Matrix::Identity(3, 3), Vector::Ones(3), Vector::Ones(2)), Error);
}

} // namespace rbvi::mixed_qp_test
