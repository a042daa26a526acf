#include "../linear_algebra.hpp"
#include "lcp_violation.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/method/lcp.hpp"

#include "columns.hpp"
#include "random_matrix.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

namespace rbvi::lcp_test {

namespace {

LcpResult expect_solved(const Matrix &h, const Vector &q, const std::vector<Index> &start = {}) {
  std::set<Index> given;
  const LcpResult result = solve_lcp(once(h, given), q, start);
  EXPECT_TRUE(result.converged) << result.reason;
  EXPECT_EQ(result.columns, static_cast<int>(given.size()));
  EXPECT_LT(lcp_violation(h, q, result.x), 2e-13);
  EXPECT_LE((result.w - (h * result.x + q)).norm(), 1e-13 * (q.norm() + (h * result.x).norm()));
  EXPECT_TRUE(std::is_sorted(result.active.begin(), result.active.end()));
  return result;
}

Matrix laplacian(Index side) {
  Matrix a = Matrix::Zero(side * side, side * side);
  for (Index i = 0; i < side; ++i)
    for (Index j = 0; j < side; ++j) {
      const Index k = i * side + j;
      a(k, k) = 4;
      if (i > 0) a(k, k - side) = a(k - side, k) = -1;
      if (j > 0) a(k, k - 1) = a(k - 1, k) = -1;
    }
  return a;
}

/// Symmetric positive definite, and plain exchange of all violated entries returns to a set that it
/// has visited: found by a random search, checked by the test that uses it.
bool plain_exchange_cycles(const Matrix &h, const Vector &q) {
  std::set<unsigned> seen;
  for (unsigned set = 0;;) {
    if (!seen.insert(set).second) return true;
    std::vector<Index> active;
    for (Index i = 0; i < q.size(); ++i)
      if ((set >> i & 1u) != 0) active.push_back(i);
    Vector x = Vector::Zero(q.size());
    if (!active.empty()) x(active) = -solved(h(active, active), q(active));
    const Vector w = h * x + q;
    unsigned flips = 0;
    for (Index i = 0; i < q.size(); ++i)
      if ((set >> i & 1u) != 0 ? x[i] < 0 : w[i] < 0) flips |= 1u << i;
    if (flips == 0) return false;
    set ^= flips;
  }
}

} // namespace

TEST(Lcp, RandomPositiveDefiniteMatrices) {
  Random random(1);
  for (int k = 0; k < 200; ++k) {
    const Index n = 1 + k % 40;
    const Matrix b = random.matrix(n, n);
    const Matrix h = b * b.transpose() + 1e-3 * Matrix::Identity(n, n);
    const Vector q = random.vector(n);
    const LcpResult cold = expect_solved(h, q);
    std::vector<Index> start;
    for (Index i = n - 1; i >= 0; --i)
      if (random() > 0) start.push_back(i);
    const LcpResult other = expect_solved(h, q, start);
    EXPECT_EQ(cold.active, other.active);
    EXPECT_EQ(expect_solved(h, q, cold.active).iterations, 1);
  }
}

TEST(Lcp, EntersMonotonicallyForMMatrices) {
  Random random(2);
  const Matrix h = laplacian(10);
  for (int k = 0; k < 20; ++k) {
    const LcpResult result = expect_solved(h, random.vector(100));
    EXPECT_EQ(result.backup_steps, 0);
    EXPECT_LT(result.iterations, 20);
  }
}

TEST(Lcp, FindsAConstructedSolution) {
  Random random(3);
  const Index side = 15, n = side * side;
  const Matrix h = laplacian(side).inverse();
  Vector x = Vector::Zero(n), w = Vector::Zero(n);
  for (Index i = 0; i < n; ++i)
    (random() > 0 ? x[i] : w[i]) = 1.5 + random();
  std::vector<Index> everywhere;
  for (Index i = 0; i < n; ++i)
    everywhere.push_back(i);
  for (const auto &start : {std::vector<Index>{}, everywhere, std::vector<Index>{7, 7, 3, 200}}) {
    const LcpResult result = expect_solved(h, w - h * x, start);
    EXPECT_LT((result.x - x).norm(), 1e-12 * x.norm());
  }
}

TEST(Lcp, EndsWhereThePlainExchangeCycles) {
  Random random(4);
  int cycles = 0;
  for (int k = 0; k < 60000 && cycles < 10; ++k) {
    const Index n = 3 + k % 6;
    const Matrix b = random.matrix(n, n);
    const Matrix h = b * b.transpose() + 1e-3 * Matrix::Identity(n, n);
    const Vector q = random.vector(n);
    if (!plain_exchange_cycles(h, q)) continue;
    ++cycles;
    EXPECT_GT(expect_solved(h, q).backup_steps, 0);
  }
  EXPECT_EQ(cycles, 10);
}

TEST(Lcp, OneEntryAllActiveNoneActive) {
  const Matrix two = Matrix::Constant(1, 1, 2.0);
  EXPECT_EQ(expect_solved(two, Vector{{-3}}).x[0], 1.5);
  EXPECT_EQ(expect_solved(two, Vector{{3}}, {0}).x[0], 0);
  EXPECT_EQ(expect_solved(two, Vector{{0}}, {0}).x[0], 0);
  const Matrix h = laplacian(4);
  EXPECT_EQ(expect_solved(h, -Vector::Ones(16)).active.size(), 16u);
  const LcpResult none = expect_solved(h, Vector::Ones(16));
  EXPECT_TRUE(none.active.empty());
  EXPECT_EQ(none.columns, 0);
  EXPECT_TRUE(solve_lcp({}, Vector(), {}).converged);
}

TEST(Lcp, DegenerateEntriesWithBothSidesZero) {
  Random random(5);
  const Index side = 8, n = side * side;
  const Matrix h = laplacian(side).inverse();
  for (int k = 0; k < 50; ++k) {
    Vector x = Vector::Zero(n), w = Vector::Zero(n);
    std::vector<Index> start;
    for (Index i = 0; i < n; ++i) {
      const double draw = random();
      if (draw > 0.4) x[i] = draw;
      if (draw < -0.4) w[i] = -draw;
      if (random() > 0) start.push_back(i);
    }
    const LcpResult result = expect_solved(h, w - h * x, start);
    EXPECT_LT((result.x - x).norm(), 1e-12 * x.norm());
    EXPECT_LT(result.iterations, 100);
  }
}

TEST(Lcp, DoesNotDependOnUnitsOrOnTheScaleOfTheBasis) {
  Random random(6);
  const Index n = 30;
  const Matrix b = random.matrix(n, n);
  const Matrix h = b * b.transpose() + 1e-2 * Matrix::Identity(n, n);
  const Vector q = random.vector(n);
  const LcpResult plain = expect_solved(h, q);
  const Vector d = Vector::NullaryExpr(n, [&] { return std::pow(10, 6 * random()); });
  const Matrix scaled = d.asDiagonal() * h * d.asDiagonal();
  const LcpResult result = expect_solved(scaled, d.cwiseProduct(q));
  EXPECT_EQ(result.active, plain.active);
  EXPECT_LT((result.x.cwiseProduct(d) - plain.x).norm(), 1e-12 * plain.x.norm());
  EXPECT_EQ(expect_solved(1e-200 * h, 1e-100 * q).active, plain.active);
}

TEST(Lcp, SaysWhatIsWrong) {
  std::set<Index> given;
  Matrix h = Matrix::Identity(2, 2);
  h(1, 1) = -1;
  const LcpResult indefinite = solve_lcp(once(h, given), -Vector::Ones(2), {});
  EXPECT_FALSE(indefinite.converged);
  EXPECT_NE(indefinite.reason.find("not positive definite"), std::string::npos);

  const ColumnSource columns = columns_of(h);
  const auto short_columns = [](const std::vector<Index> &) { return Matrix(Matrix::Ones(2, 1)); };
  EXPECT_THROW(solve_lcp(short_columns, -Vector::Ones(2), {}), Error);
  EXPECT_THROW(solve_lcp(columns, -Vector::Ones(2), {2}), Error);
  EXPECT_THROW(solve_lcp(columns, -Vector::Ones(2), {-1}), Error);
  Vector bad = Vector::Ones(2);
  bad[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(solve_lcp(columns, bad, {}), Error);

  const Matrix b = Random(7).matrix(20, 20);
  const Matrix spd = b * b.transpose();
  given.clear();
  const LcpResult stopped =
      solve_lcp(once(spd, given), -Vector::Ones(20), {}, {.max_iterations = 1});
  EXPECT_FALSE(stopped.converged);
  EXPECT_NE(stopped.reason.find("raise the limit"), std::string::npos);
}

} // namespace rbvi::lcp_test
