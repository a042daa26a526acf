#include "rbvi/law/general_lcp.hpp"

#include "pivoting.hpp"
#include "rbvi/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace rbvi {

namespace {

using namespace pivoting;

constexpr double pivot_tolerance = 1e-13;

/// The problem of unit * z: its matrix has diagonal entries between 1/2 and 2 where that of M is
/// not zero. Powers of two, so that nothing is rounded.
struct ScaledLcp {
  Matrix m;
  Vector q, unit;
};

Vector units(const Matrix &m) {
  const Vector root = m.diagonal().cwiseAbs().cwiseSqrt();
  Vector unit = root;
  for (Index i = 0; i < m.rows(); ++i) {
    for (Index j = 0; root[i] == 0 && j < m.rows(); ++j)
      if (root[j] > 0)
        unit[i] = std::max({unit[i], std::abs(m(i, j)) / root[j], std::abs(m(j, i)) / root[j]});
    unit[i] = unit[i] > 0 ? std::ldexp(1.0, std::ilogb(unit[i])) : 1.0;
  }
  return unit;
}

ScaledLcp scaled(const Matrix &m, const Vector &q) {
  const Vector unit = units(m), inverse = unit.cwiseInverse();
  return {inverse.asDiagonal() * m * inverse.asDiagonal(), inverse.cwiseProduct(q), unit};
}

BasicSolution solve_basis(const ScaledLcp &problem, std::vector<Index> active) {
  BasicSolution basic;
  basic.active = std::move(active);
  basic.w = problem.q;
  Vector terms = problem.q.cwiseAbs();
  if (!basic.active.empty()) {
    const Matrix block = problem.m(basic.active, basic.active);
    const Vector right = problem.q(basic.active);
    const Eigen::PartialPivLU<Matrix> lu(block);
    const Vector pivots = lu.matrixLU().diagonal().cwiseAbs();
    const double noise =
        std::numeric_limits<double>::epsilon() * static_cast<double>(pivots.size());
    basic.regular = pivots.minCoeff() > noise * pivots.maxCoeff();
    if (!basic.regular) return basic;
    basic.x = -lu.solve(right);
    basic.x -= lu.solve(Vector(block * basic.x + right));
    basic.regular = basic.x.allFinite();
    if (!basic.regular) return basic;
  }
  for (Index k = 0; k < basic.x.size(); ++k) {
    const auto column = problem.m.col(basic.active[at(k)]);
    basic.w += basic.x[k] * column;
    terms += std::abs(basic.x[k]) * column.cwiseAbs();
  }
  find_violations(basic, basic.x, terms, pivot_tolerance);
  return basic;
}

/// Block exchange from the active set of `basic`; true: nothing is violated any more.
bool block_pivoting(const ScaledLcp &problem, BasicSolution &basic, int &iterations) {
  Policy<std::vector<Index>, std::size_t> policy(/*patience=*/10);
  for (;;) {
    basic = solve_basis(problem, std::move(basic.active));
    ++iterations;
    if (!basic.regular) return false;
    if (basic.violated.empty()) return true;
    if (policy.after(basic.active, basic.violated.size()) == Exchange::fallback) return false;
    basic.active = exchanged(basic.active, basic.violated);
  }
}

/// Almost complementary bases of  w - M z - 1 z0 = q,  with the inverse of the basis kept: its rows
/// are also what breaks ties lexicographically.
class Lemke {
public:
  enum class End { solved, ray, limit };

  explicit Lemke(const ScaledLcp &problem)
      : problem_(problem), n_(problem.q.size()), inverse_(Matrix::Identity(n_, n_)) {
    for (Index i = 0; i < n_; ++i)
      basis_.push_back(i);
  }

  End run(int &iterations) {
    const int limit = 100 + 50 * static_cast<int>(n_);
    if (problem_.q.minCoeff() >= 0) return End::solved;
    Index leaving = most_negative(), entering = 2 * n_;
    for (int k = 0; k < limit; ++k) {
      ++iterations;
      const Index left = exchange(leaving, entering);
      if (left == 2 * n_) return End::solved;
      entering = left < n_ ? left + n_ : left - n_;
      leaving = ratio_test(entering);
      if (leaving < 0) return End::ray;
    }
    return End::limit;
  }

  std::vector<Index> active() const {
    std::vector<Index> result;
    for (const Index variable : basis_)
      if (variable >= n_ && variable < 2 * n_) result.push_back(variable - n_);
    std::sort(result.begin(), result.end());
    return result;
  }

private:
  // Variables: w_0, ..., then z_0, ..., then the artificial one.
  Vector column(Index variable) const {
    if (variable < n_) return Vector::Unit(n_, variable);
    if (variable < 2 * n_) return -problem_.m.col(variable - n_);
    return -Vector::Ones(n_);
  }

  /// The last of equals: the rows of the others stay lexicographically positive.
  Index most_negative() const {
    Index row = 0;
    for (Index i = 1; i < n_; ++i)
      if (problem_.q[i] <= problem_.q[row]) row = i;
    return row;
  }

  Index exchange(Index row, Index entering) {
    Vector factors = inverse_ * column(entering);
    inverse_.row(row) /= factors[row];
    factors[row] = 0;
    const Vector pivot = inverse_.row(row);
    inverse_.noalias() -= factors * pivot.transpose();
    return std::exchange(basis_[at(row)], entering);
  }

  /// The row that leaves, the artificial variable first; negative: none, a ray.
  Index ratio_test(Index entering) const {
    constexpr double noise = 1e-12;
    const Matrix sizes = inverse_.cwiseAbs();
    const Vector right = column(entering), slope = inverse_ * right,
                 slope_terms = sizes * right.cwiseAbs();
    const Vector value = (inverse_ * problem_.q).cwiseMax(0.0),
                 value_noise = noise * (sizes * problem_.q.cwiseAbs());
    double least = std::numeric_limits<double>::infinity();
    for (Index i = 0; i < n_; ++i)
      if (slope[i] > noise * slope_terms[i])
        least = std::min(least, (value[i] + value_noise[i]) / slope[i]);
    Index best = -1;
    for (Index i = 0; i < n_; ++i) {
      if (!(slope[i] > noise * slope_terms[i]) || value[i] / slope[i] > least) continue;
      if (basis_[at(i)] == 2 * n_) return i;
      if (best < 0 || before(i, best, slope)) best = i;
    }
    return best;
  }

  bool before(Index a, Index b, const Vector &slope) const {
    for (Index j = 0; j < n_; ++j) {
      const double left = inverse_(a, j) / slope[a], right = inverse_(b, j) / slope[b];
      if (std::abs(left - right) > 1e-11 * (std::abs(left) + std::abs(right))) return left < right;
    }
    return false;
  }

  const ScaledLcp &problem_;
  Index n_;
  Matrix inverse_;
  std::vector<Index> basis_; ///< the variable of every row
};

void check(const Matrix &m, const Vector &q) {
  if (m.rows() != q.size() || m.cols() != q.size())
    throw failure("LCP: the matrix is " + std::to_string(m.rows()) + " x " +
                  std::to_string(m.cols()) + ", but the right-hand side has " +
                  std::to_string(q.size()) + " entries");
  if (!m.allFinite() || !q.allFinite())
    throw failure("LCP: the matrix or the right-hand side is not finite");
}

std::string failed(Lemke::End end) {
  if (end == Lemke::End::ray)
    return "Lemke's method ended on a ray: the problem has no solution, or its matrix is neither "
           "positive semidefinite nor a P-matrix; check the matrix and the right-hand side";
  if (end == Lemke::End::limit)
    return "Lemke's method has not ended: the matrix is close to singular; remove dependent rows";
  return "the basis that Lemke's method found violates the signs beyond round-off: the matrix is "
         "close to singular; remove dependent rows";
}

} // namespace

GeneralLcpResult solve_general_lcp(const Matrix &m, const Vector &q,
                                   const std::vector<Index> &start) {
  GeneralLcpResult result;
  check(m, q);
  BasicSolution basic;
  basic.active = checked_guess(start, q.size());
  const ScaledLcp problem = scaled(m, q);
  result.converged = block_pivoting(problem, basic, result.iterations);
  if (!result.converged) {
    Lemke lemke(problem);
    const Lemke::End end = lemke.run(result.iterations);
    basic.active = lemke.active();
    result.converged =
        end == Lemke::End::solved && block_pivoting(problem, basic, result.iterations);
    if (!result.converged) result.reason = failed(end);
  }
  result.z = Vector::Zero(q.size());
  result.w = q;
  if (!result.converged) return result;
  result.reason = "no violation left";
  result.active = basic.active;
  if (basic.x.size() > 0)
    result.z(basic.active) = basic.x.cwiseMax(0.0).cwiseQuotient(problem.unit(basic.active));
  result.w = basic.w.cwiseProduct(problem.unit);
  return result;
}

} // namespace rbvi
