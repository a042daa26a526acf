#include "../linear_algebra.hpp"
#include "lcp_violation.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/law/general_lcp.hpp"
#include "rbvi/law/lcp.hpp"

#include "columns.hpp"
#include "random_matrix.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace rbvi::general_lcp_test {

namespace {

GeneralLcpResult expect_solved(const Matrix &m, const Vector &q,
                               const std::vector<Index> &start = {}) {
  GeneralLcpResult result = solve_general_lcp(m, q, start);
  EXPECT_TRUE(result.converged) << result.reason;
  EXPECT_LT(lcp_violation(m, q, result.z), 5e-13);
  EXPECT_LE((result.w - (m * result.z + q)).norm(), 1e-12 * (q.norm() + (m * result.z).norm()));
  EXPECT_TRUE(std::is_sorted(result.active.begin(), result.active.end()));
  for (Index i = 0; i < q.size(); ++i)
    EXPECT_TRUE(result.z[i] == 0 ||
                std::binary_search(result.active.begin(), result.active.end(), i));
  return result;
}

/// Not symmetric; its symmetric part is positive definite.
Matrix random_positive_definite(Random &random, Index n, double least = 1e-2) {
  const Matrix b = random.matrix(n, n), c = random.matrix(n, n);
  return b * b.transpose() + least * Matrix::Identity(n, n) + 2 * (c - c.transpose());
}

std::vector<Index> members(unsigned set, Index n) {
  std::vector<Index> result;
  for (Index i = 0; i < n; ++i)
    if ((set >> i & 1u) != 0) result.push_back(i);
  return result;
}

/// z of one active set, whatever its signs.
Vector basic(const Matrix &m, const Vector &q, const std::vector<Index> &active) {
  Vector z = Vector::Zero(q.size());
  if (!active.empty()) z(active) = -solved(m(active, active), q(active));
  return z;
}

/// All solutions that are basic.
std::vector<Vector> brute_force(const Matrix &m, const Vector &q) {
  std::vector<Vector> result;
  for (unsigned set = 0; set < 1u << q.size(); ++set) {
    const Vector z = basic(m, q, members(set, q.size()));
    if (z.allFinite() && lcp_violation(m, q, z.cwiseMax(0.0)) < 1e-11 && z.minCoeff() > -1e-11)
      result.push_back(z);
  }
  return result;
}

/// Whether the exchange of all violated entries, from an active set on, returns to one.
bool plain_exchange_cycles(const Matrix &m, const Vector &q, unsigned set = 0) {
  std::set<unsigned> seen;
  for (;;) {
    if (!seen.insert(set).second) return true;
    const Vector z = basic(m, q, members(set, q.size())), w = m * z + q;
    unsigned flips = 0;
    for (Index i = 0; i < q.size(); ++i)
      if ((set >> i & 1u) != 0 ? z[i] < 0 : w[i] < 0) flips |= 1u << i;
    if (flips == 0) return false;
    set ^= flips;
  }
}

std::vector<Index> random_start(Random &random, Index n) {
  std::vector<Index> start;
  for (Index i = n - 1; i >= 0; --i)
    if (random() > 0) start.push_back(i);
  return start;
}

} // namespace

TEST(GeneralLcp, PositiveDefiniteMatricesThatAreNotSymmetric) {
  Random random(1);
  for (int k = 0; k < 200; ++k) {
    const Index n = 1 + k % 40;
    const Matrix m = random_positive_definite(random, n, 1e-3);
    const Vector q = random.vector(n);
    const GeneralLcpResult cold = expect_solved(m, q);
    EXPECT_EQ(expect_solved(m, q, random_start(random, n)).active, cold.active);
    EXPECT_EQ(expect_solved(m, q, cold.active).iterations, 1);
  }
}

TEST(GeneralLcp, FindsTheSolutionThatEnumerationFinds) {
  Random random(2);
  for (int k = 0; k < 100; ++k) {
    const Index n = 1 + k % 8;
    const Matrix m = random_positive_definite(random, n);
    const Vector q = random.vector(n);
    const std::vector<Vector> solutions = brute_force(m, q);
    ASSERT_EQ(solutions.size(), 1u);
    EXPECT_LT((expect_solved(m, q).z - solutions[0]).norm(), 1e-11 * (1 + solutions[0].norm()));
  }
}

TEST(GeneralLcp, PMatricesThatAreNotPositiveDefinite) {
  Random random(3);
  for (int k = 0; k < 100; ++k) {
    const Index n = 2 + k % 20;
    // Columns of a positive definite matrix at will; triangular ones with large entries.
    const Vector d = Vector::NullaryExpr(n, [&] { return std::pow(10, 2 * random()); });
    const Matrix columns = random_positive_definite(random, n) * d.asDiagonal();
    const Vector q = random.vector(n);
    const GeneralLcpResult result = expect_solved(columns, q);
    EXPECT_EQ(expect_solved(columns, q, random_start(random, n)).active, result.active);
    Matrix triangular = 3 * random.matrix(n, n);
    triangular.diagonal().setOnes();
    triangular.triangularView<Eigen::StrictlyUpper>().setZero();
    // Forward substitution.
    Vector z = Vector::Zero(n);
    for (Index i = 0; i < n; ++i)
      z[i] = std::max(0.0, -q[i] - triangular.row(i).head(i).dot(z.head(i)));
    EXPECT_LE((expect_solved(triangular, q).z - z).norm(), 1e-9 * z.norm());
  }
}

TEST(GeneralLcp, EndsWhereTheExchangeOfAllViolatedEntriesCycles) {
  // Ben Gharbia and Gilbert (2012): {0}, {2}, {1}, {0}, ...; the solution is zero.
  const Matrix m{{1, 2, 0}, {0, 1, 2}, {2, 0, 1}};
  ASSERT_TRUE(plain_exchange_cycles(m, Vector::Ones(3), 1));
  EXPECT_EQ(expect_solved(m, Vector::Ones(3), {0}).z, Vector::Zero(3));

  Random random(4);
  int cycles = 0;
  for (int k = 0; k < 20000 && cycles < 20; ++k) {
    const Index n = 3 + k % 6;
    const Matrix other = random_positive_definite(random, n, 1e-3);
    const Vector q = random.vector(n);
    if (!plain_exchange_cycles(other, q)) continue;
    ++cycles;
    const std::vector<Vector> solutions = brute_force(other, q);
    ASSERT_EQ(solutions.size(), 1u);
    EXPECT_LT((expect_solved(other, q).z - solutions[0]).norm(), 1e-11 * solutions[0].norm());
  }
  EXPECT_EQ(cycles, 20);
}

TEST(GeneralLcp, AgreesWithTheSymmetricSolver) {
  Random random(5);
  for (int k = 0; k < 50; ++k) {
    const Index n = 1 + k;
    const Matrix b = random.matrix(n, n), h = b * b.transpose() + 1e-2 * Matrix::Identity(n, n);
    const Vector q = random.vector(n);
    const LcpResult expected = solve_lcp(columns_of(h), q, {});
    const GeneralLcpResult result = expect_solved(h, q);
    EXPECT_EQ(result.active, expected.active);
    EXPECT_LT((result.z - expected.x).norm(), 1e-11 * (1 + expected.x.norm()));
  }
}

TEST(GeneralLcp, DegenerateEntriesWithBothSidesZero) {
  Random random(6);
  for (int k = 0; k < 100; ++k) {
    const Index n = 2 + k % 40;
    const Matrix m = random_positive_definite(random, n, 1);
    Vector z = Vector::Zero(n), w = Vector::Zero(n);
    for (Index i = 0; i < n; ++i) {
      const double draw = random();
      if (draw > 0.4) z[i] = draw;
      if (draw < -0.4) w[i] = -draw;
    }
    const Vector q = w - m * z;
    EXPECT_LT((expect_solved(m, q, random_start(random, n)).z - z).norm(), 1e-11 * (1 + z.norm()));
    EXPECT_EQ(expect_solved(m, Vector::Zero(n), random_start(random, n)).z, Vector::Zero(n));
  }
}

TEST(GeneralLcp, SingularPositiveSemidefiniteMatrices) {
  Random random(7);
  for (int k = 0; k < 100; ++k) {
    const Index n = 4 + k % 20;
    const Matrix b = random.matrix(n, n / 3), c = random.matrix(n, n);
    const Matrix m = b * b.transpose() + (k % 2) * (c - c.transpose());
    // Feasible, hence solvable.
    const Vector q = random.vector(n).cwiseAbs() - m * random.vector(n).cwiseAbs();
    expect_solved(m, q);
    expect_solved(m, q, random_start(random, n));
  }
}

TEST(GeneralLcp, LinearProgramsHaveNoDiagonalAtAll) {
  // min c . x,  A x >= b,  x >= 0, and its dual.
  Random random(8);
  for (int k = 0; k < 50; ++k) {
    const Index rows = 2 + k % 7, columns = 3 + k % 5;
    const Matrix a = random.matrix(rows, columns);
    const Vector x = random.vector(columns).cwiseAbs(), y = random.vector(rows).cwiseAbs();
    Matrix m = Matrix::Zero(rows + columns, rows + columns);
    m.topRightCorner(columns, rows) = -a.transpose();
    m.bottomLeftCorner(rows, columns) = a;
    Vector q(rows + columns);
    q << a.transpose() * y + random.vector(columns).cwiseAbs(),
        -(a * x) + random.vector(rows).cwiseAbs();
    const Vector z = expect_solved(m, q).z;
    // Both objectives agree.
    EXPECT_NEAR(q.head(columns).dot(z.head(columns)), -q.tail(rows).dot(z.tail(rows)), 1e-11);
  }
}

TEST(GeneralLcp, TiesAndCopiesOfOneRow) {
  const Index n = 12;
  // Rank one, all rows equal: sum z = 1.
  const Matrix ones = Matrix::Ones(n, n);
  EXPECT_NEAR(expect_solved(ones, -Vector::Ones(n)).z.sum(), 1, 1e-14);
  const Matrix m =
      Matrix::Identity(n, n) + ones.triangularView<Eigen::StrictlyLower>().toDenseMatrix();
  EXPECT_EQ(expect_solved(m, -Vector::Ones(n)).z, Vector::Unit(n, 0));
}

TEST(GeneralLcp, OneEntryOrNone) {
  const Matrix two = Matrix::Constant(1, 1, 2.0);
  EXPECT_EQ(expect_solved(two, Vector{{-3}}).z[0], 1.5);
  EXPECT_EQ(expect_solved(two, Vector{{3}}, {0}).z[0], 0);
  EXPECT_EQ(expect_solved(Matrix::Zero(1, 1), Vector{{1}}, {0}).z[0], 0);
  EXPECT_TRUE(solve_general_lcp(Matrix(0, 0), Vector()).converged);
}

TEST(GeneralLcp, DoesNotDependOnUnits) {
  Random random(9);
  const Index n = 30;
  for (int k = 0; k < 20; ++k) {
    const Matrix m = random_positive_definite(random, n);
    const Vector q = random.vector(n);
    const GeneralLcpResult plain = expect_solved(m, q);
    const Vector d = Vector::NullaryExpr(n, [&] { return std::pow(10, 6 * random()); });
    const GeneralLcpResult result =
        expect_solved(d.asDiagonal() * m * d.asDiagonal(), d.cwiseProduct(q));
    EXPECT_EQ(result.active, plain.active);
    EXPECT_LT((result.z.cwiseProduct(d) - plain.z).norm(), 1e-11 * plain.z.norm());
    EXPECT_EQ(expect_solved(1e-200 * m, 1e-100 * q).active, plain.active);
  }
}

TEST(GeneralLcp, SaysThatThereIsNoSolution) {
  for (const Index n : {1, 2, 5}) {
    const GeneralLcpResult none = solve_general_lcp(-Matrix::Identity(n, n), -Vector::Ones(n));
    EXPECT_FALSE(none.converged);
    EXPECT_NE(none.reason.find("no solution"), std::string::npos);
    EXPECT_EQ(none.z, Vector::Zero(n));
    EXPECT_EQ(none.w, -Vector::Ones(n));
  }
  // Singular and not feasible: z_0 - z_1 is at least 1, and at most -1.
  const Matrix m{{1, -1}, {-1, 1}};
  EXPECT_FALSE(solve_general_lcp(m, -Vector::Ones(2)).converged);
  EXPECT_FALSE(solve_general_lcp(Matrix::Zero(3, 3), -Vector::Ones(3)).converged);
}

TEST(GeneralLcp, RefusesBadInput) {
  const Matrix m = Matrix::Identity(2, 2);
  const Vector q = Vector::Ones(2);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(solve_general_lcp(m, Vector::Ones(3)), Error);
  EXPECT_THROW(solve_general_lcp(Matrix::Ones(2, 3), q), Error);
  EXPECT_THROW(solve_general_lcp(m, q, {2}), Error);
  EXPECT_THROW(solve_general_lcp(m, q, {-1}), Error);
  EXPECT_THROW(solve_general_lcp(m, Vector::Constant(2, nan)), Error);
  EXPECT_THROW(solve_general_lcp(Matrix::Constant(2, 2, nan), q), Error);
}

} // namespace rbvi::general_lcp_test
