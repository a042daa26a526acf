#include "../linear_algebra.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/method/nonnegative_qp.hpp"

#include "random_matrix.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rbvi::nonnegative_qp_test {

namespace {

;

double objective(const Matrix &y, const Vector &c, const Vector &g, const Vector &x) {
  return 0.5 * (y * x - c).squaredNorm() + g.dot(x);
}

/// Independent of the solver: the least objective over the minima of every set of columns that is
/// independent and has a positive minimiser.
double brute_force(const Matrix &y, const Vector &c, const Vector &g) {
  const Index r = y.cols();
  double best = 0.5 * c.squaredNorm();
  for (unsigned set = 1; set < (1u << r); ++set) {
    std::vector<Index> columns;
    for (Index j = 0; j < r; ++j)
      if ((set >> j & 1u) != 0) columns.push_back(j);
    const Matrix part = y(Eigen::all, columns);
    const Vector norms = part.colwise().norm();
    if (norms.minCoeff() == 0) continue;
    const Matrix unit = part * norms.cwiseInverse().asDiagonal();
    if (rank_of(unit, 1e-9) < unit.cols()) continue;
    const Matrix gram = unit.transpose() * unit;
    const Vector right = unit.transpose() * c - Vector(g(columns)).cwiseQuotient(norms);
    const Vector x = gram.ldlt().solve(right).cwiseQuotient(norms);
    if (x.minCoeff() < 0) continue;
    best = std::min(best, objective(part, c, g(columns), x));
  }
  return best;
}

/// Largest violation of the optimality conditions, each relative to its own terms.
double kkt_violation(const Matrix &y, const Vector &c, const Vector &g, const Vector &x) {
  const Vector image = y * x, gradient = y.transpose() * (image - c) + g;
  double worst = 0;
  for (Index j = 0; j < x.size(); ++j) {
    const double size = y.col(j).norm() * (c.norm() + image.norm()) + std::abs(g[j]);
    if (size == 0) continue;
    if (x[j] < 0) return std::numeric_limits<double>::infinity();
    worst = larger(worst, (x[j] > 0 ? std::abs(gradient[j]) : -gradient[j]) / size);
  }
  return worst;
}

void expect_solved(const Matrix &y, const Vector &c, const Vector &g) {
  NonnegativeQp qp(y.rows());
  const auto report = qp.solve(y, c, g);
  ASSERT_TRUE(report.converged);
  EXPECT_LT(kkt_violation(y, c, g, qp.x()), 1e-12);
  EXPECT_LE((qp.residual() - (c - y * qp.x())).norm(), 1e-12 * (c.norm() + (y * qp.x()).norm()));
  const double best = brute_force(y, c, g);
  EXPECT_NEAR(objective(y, c, g, qp.x()), best, 1e-11 * (std::abs(best) + c.squaredNorm()));
}

/// g for which the dual has a feasible point: g = Y^T z + slack with slack >= 0.
Vector bounded_linear_term(const Matrix &y, Random &random) {
  const Vector slack = random.vector(y.cols()).cwiseMax(0);
  return y.transpose() * random.vector(y.rows()) +
         slack.cwiseProduct(y.colwise().norm().transpose());
}

} // namespace

TEST(UpdatableQr, StaysAFactorisationUnderAppendAndRemove) {
  Random random(1);
  const Index m = 12;
  UpdatableQr qr(m);
  std::vector<Vector> columns;
  for (int step = 0; step < 400; ++step) {
    const bool take =
        columns.empty() || (random() > -0.2 && static_cast<Index>(columns.size()) < m);
    if (take) {
      columns.push_back(random.vector(m) * std::pow(10, 6 * random()));
      ASSERT_TRUE(qr.append(columns.back(), 1e-10));
    } else {
      const auto position =
          static_cast<Index>((0.5 + 0.499 * random()) * static_cast<double>(columns.size()));
      qr.remove(position);
      columns.erase(columns.begin() + position);
    }
    const Index k = static_cast<Index>(columns.size());
    ASSERT_EQ(qr.size(), k);
    EXPECT_LT((qr.q().transpose() * qr.q() - Matrix::Identity(k, k)).norm(), 1e-12);
    EXPECT_TRUE(Matrix(qr.r()).isUpperTriangular(0));
    for (Index j = 0; j < k; ++j) {
      const Vector &column = columns[j];
      EXPECT_LT((qr.q() * qr.r().col(j) - column).norm(), 1e-12 * column.norm());
    }
  }
}

TEST(UpdatableQr, RefusesDependentColumnsAndChangesNothing) {
  Random random(2);
  const Matrix y = random.matrix(6, 3);
  UpdatableQr qr(6);
  for (Index j = 0; j < 3; ++j)
    ASSERT_TRUE(qr.append(y.col(j), 1e-10));
  EXPECT_FALSE(qr.append(1e7 * (y.col(0) - 2 * y.col(2)), 1e-10));
  EXPECT_FALSE(qr.append(Vector::Zero(6), 1e-10));
  EXPECT_EQ(qr.size(), 3);
  EXPECT_LT((qr.q() * qr.r() - y).norm(), 1e-14);
  EXPECT_TRUE(qr.append(y.col(0) + 1e-8 * random.vector(6), 1e-10));
  EXPECT_LT((qr.q().transpose() * qr.q() - Matrix::Identity(4, 4)).norm(), 1e-13);
}

TEST(UpdatableQr, AssignsABlockUnlessItIsNearlyDependent) {
  Random random(3);
  Matrix y = random.matrix(40, 20);
  y.col(7) = y.col(3) + 1e-3 * y.col(7);
  y.colwise().normalize();
  UpdatableQr qr(40);
  ASSERT_TRUE(qr.assign(y));
  EXPECT_LT((qr.q().transpose() * qr.q() - Matrix::Identity(20, 20)).norm(), 1e-13);
  EXPECT_LT((qr.q() * qr.r() - y).norm(), 1e-13);
  EXPECT_TRUE(Matrix(qr.r()).isUpperTriangular(0));
  y.col(9) = (y.col(3) + 1e-8 * y.col(9)).normalized();
  EXPECT_FALSE(qr.assign(y));
  EXPECT_EQ(qr.size(), 0);
}

TEST(NonnegativeQp, AgreesWithAllActiveSets) {
  Random random(4);
  for (int k = 0; k < 300; ++k) {
    const Index m = 1 + k % 8, r = 1 + (k / 8) % 8;
    const Matrix y = random.matrix(m, r);
    const Vector c = random.vector(m);
    expect_solved(y, c, Vector::Zero(r));
    expect_solved(y, c, bounded_linear_term(y, random));
    expect_solved(y, c, random.vector(r).cwiseAbs());
  }
}

TEST(NonnegativeQp, AgreesWithAllActiveSetsForDegenerateColumns) {
  Random random(5);
  for (int k = 0; k < 300; ++k) {
    const Index m = 2 + k % 5, r = 7;
    Matrix y = random.matrix(m, r);
    if (k % 2 == 0) y = y.cwiseMax(0);
    y.col(3) = y.col(0);
    y.col(4) = 0.5 * y.col(1) + 0.5 * y.col(2);
    y.col(6).setZero();
    for (Index j = 0; j < r; ++j)
      if (k % 3 == 0) y.col(j) *= std::pow(10, 8 * random());
    const Vector c = k % 5 == 0 ? Vector(y.col(0) / (y.col(0).norm() + 1e-300)) : random.vector(m);
    expect_solved(y, c, Vector::Zero(r));
    expect_solved(y, c, bounded_linear_term(y, random));
  }
}

TEST(NonnegativeQp, ChoosesTheCheaperOfTwoEqualColumns) {
  Matrix y(2, 2);
  y << 1, 1, 0, 0;
  const Vector c = Vector::Unit(2, 0);
  NonnegativeQp qp(2);
  ASSERT_TRUE(qp.solve(y, c, Vector{{0.5, 0.25}}).converged);
  EXPECT_NEAR(qp.x()[0], 0, 1e-15);
  EXPECT_NEAR(qp.x()[1], 0.75, 1e-15);
  ASSERT_TRUE(qp.solve(y, c, Vector{{0.25, 0.5}}).converged);
  EXPECT_NEAR(qp.x()[0], 0.75, 1e-15);
  EXPECT_NEAR(qp.x()[1], 0, 1e-15);
}

TEST(NonnegativeQp, SeesAnUnboundedProblem) {
  Matrix y(2, 3);
  y << 1, -1, 0, 0, 0, 1;
  NonnegativeQp qp(2);
  auto report = qp.solve(y, Vector{{1, 1}}, Vector{{-2, 1, 0}});
  EXPECT_TRUE(report.unbounded);
  EXPECT_FALSE(report.converged);
  report = qp.solve(y, Vector{{1, 1}}, Vector{{-2, 2, 0}});
  EXPECT_TRUE(report.converged);
  EXPECT_NEAR((y * qp.x() - Vector{{3, 1}}).norm(), 0, 1e-14);
  report = qp.solve(y, Vector{{1, 1}}, Vector{{-1, 2, -3}});
  EXPECT_TRUE(report.converged);

  NonnegativeQp zero(2);
  EXPECT_TRUE(zero.solve(Matrix::Zero(2, 1), Vector{{1, 1}}, Vector{{-1e-20}}).unbounded);
  EXPECT_TRUE(zero.solve(Matrix::Zero(2, 1), Vector{{1, 1}}, Vector{{1e-20}}).converged);
}

TEST(NonnegativeQp, UnboundedOrSolvedForAnyLinearTerm) {
  Random random(6);
  int unbounded = 0;
  for (int k = 0; k < 500; ++k) {
    const Index m = 1 + k % 4, r = 6;
    const Matrix y = random.matrix(m, r);
    const Vector c = random.vector(m), g = random.vector(r);
    NonnegativeQp qp(m);
    const auto report = qp.solve(y, c, g);
    ASSERT_NE(report.converged, report.unbounded);
    unbounded += report.unbounded ? 1 : 0;
    // By duality: bounded if and only if some z has Y^T z <= g, found as the NNLS below (Farkas).
    Matrix extended(m + 1, r);
    extended << y, g.transpose();
    NonnegativeQp farkas(m + 1);
    ASSERT_TRUE(farkas.solve(extended, -Vector::Unit(m + 1, m)).converged);
    EXPECT_EQ(report.unbounded, farkas.residual().norm() < 1e-9);
    if (report.converged) {
      EXPECT_LT(kkt_violation(y, c, g, qp.x()), 1e-12);
    }
  }
  EXPECT_GT(unbounded, 50);
  EXPECT_LT(unbounded, 450);
}

TEST(NonnegativeQp, DoesNotDependOnTheStart) {
  Random random(7);
  for (int k = 0; k < 100; ++k) {
    const Index m = 20, r = 30;
    Matrix y = random.matrix(m, r);
    y.col(8) = y.col(2);
    const Vector c = random.vector(m), g = bounded_linear_term(y, random);
    NonnegativeQp cold(m), warm(m);
    ASSERT_TRUE(cold.solve(y, c, g).converged);
    std::vector<Index> start{-1, 99, 8, 8, 2};
    for (Index j = 0; j < r; ++j)
      if (random() > 0) start.push_back(j);
    warm.start_from(start);
    ASSERT_TRUE(warm.solve(y, c, g).converged);
    EXPECT_LT((warm.residual() - cold.residual()).norm(), 1e-11 * c.norm());
    warm.start_from(cold.active());
    EXPECT_EQ(warm.solve(y, c, g).iterations, 0);
    const Matrix changed = y + 1e-3 * random.matrix(m, r);
    const Vector other = bounded_linear_term(changed, random);
    warm.reset();
    ASSERT_TRUE(warm.solve(changed, c, other).converged);
    EXPECT_LT(kkt_violation(changed, c, other, warm.x()), 1e-12);
  }
}

TEST(NonnegativeQp, FollowsAGrowingBasisAndChangingTargets) {
  Random random(8);
  const Index m = 25;
  const Matrix y = random.matrix(m, 60).cwiseAbs();
  NonnegativeQp warm(m);
  Vector c = random.vector(m).cwiseAbs();
  double last = std::numeric_limits<double>::infinity();
  for (Index r = 0; r <= y.cols(); ++r) {
    ASSERT_TRUE(warm.solve(y.leftCols(r), c).converged);
    EXPECT_LE(warm.residual().norm(), last * (1 + 1e-12));
    last = warm.residual().norm();
    NonnegativeQp cold(m);
    ASSERT_TRUE(cold.solve(y.leftCols(r), c).converged);
    EXPECT_LT((warm.residual() - cold.residual()).norm(), 1e-12 * c.norm());
  }
  for (int k = 0; k < 200; ++k) {
    c = random.vector(m);
    ASSERT_TRUE(warm.solve(y, c).converged);
    EXPECT_LT(kkt_violation(y, c, Vector::Zero(y.cols()), warm.x()), 1e-12);
  }
}

TEST(NonnegativeQp, LeastDistanceToAPolytope) {
  // { z : z_i <= 1, z_1 + z_2 + z_3 <= d }, from (3, 1, -1): for d = 1.5 only z_1 <= 1 is in the
  // way; for d = 0.5 the last face is too: z = (1, 1 - t, -1 - t) with 1 - 2 t = 0.5.
  Matrix faces(4, 3);
  faces << Matrix::Identity(3, 3), Matrix::Ones(1, 3);
  NonnegativeQp dual(3);
  ASSERT_TRUE(dual.solve(faces.transpose(), Vector{{3, 1, -1}}, Vector{{1, 1, 1, 1.5}}).converged);
  EXPECT_LT((dual.residual() - Vector{{1, 1, -1}}).norm(), 1e-14);
  ASSERT_TRUE(dual.solve(faces.transpose(), Vector{{3, 1, -1}}, Vector{{1, 1, 1, 0.5}}).converged);
  EXPECT_LT((dual.residual() - Vector{{1, 0.75, -1.25}}).norm(), 1e-14);
}

TEST(NonnegativeQp, IllConditionedFamilyOfBumps) {
  const Index m = 150, r = 65;
  const Matrix y = Matrix::NullaryExpr(m, r, [&](Index i, Index j) {
    const double t = 12 * (static_cast<double>(i) / m - static_cast<double>(j) / r);
    return std::exp(-t * t);
  });
  Random random(9);
  const Vector c = y * random.vector(r).cwiseMax(0) + 1e-3 * random.vector(m);
  NonnegativeQp qp(m);
  ASSERT_TRUE(qp.solve(y, c).converged);
  EXPECT_LT(kkt_violation(y, c, Vector::Zero(r), qp.x()), 1e-12);
}

TEST(NonnegativeQp, ReportsWhatItCannotDo) {
  NonnegativeQp qp(3);
  EXPECT_THROW(qp.solve(Matrix::Ones(2, 2), Vector::Ones(2)), Error);
  EXPECT_THROW(qp.solve(Matrix::Ones(3, 2), Vector::Ones(3), Vector::Ones(3)), Error);
  const Vector bad = Vector::Constant(3, std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(qp.solve(Matrix::Identity(3, 3), bad).converged);
  NonnegativeQp short_run(3, {.max_iterations = 1});
  EXPECT_FALSE(short_run.solve(Matrix::Identity(3, 3), Vector::Ones(3)).converged);
  EXPECT_TRUE(qp.solve(Matrix::Identity(3, 3), Vector::Ones(3)).converged);
}

} // namespace rbvi::nonnegative_qp_test
