#include "rbvi/law/lcp.hpp"

#include "lazy_columns.hpp"
#include "rbvi/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace rbvi {

namespace {

/// Basic solution of one active set: x = 0 outside, w = 0 inside.
struct Basic {
  std::vector<Index> active;
  Vector x; ///< of the active entries
  Vector w; ///< of all entries
  std::vector<Index> violated;
  bool regular = true; ///< the active block is positive definite
};

/// Violations are relative to the terms of their own row, and to the largest x in the scaling in
/// which H has a unit diagonal, so that neither units nor the sizes of basis functions matter.
void find_violations(Basic &basic, const Vector &diagonal, const Vector &scale, double tolerance) {
  const Index count = static_cast<Index>(basic.active.size());
  const Vector scaled = basic.x.cwiseProduct(diagonal.cwiseSqrt());
  const double largest = count > 0 ? scaled.cwiseAbs().maxCoeff() : 0.0;
  std::vector<char> inside(static_cast<std::size_t>(basic.w.size()), 0);
  basic.violated.clear();
  for (Index k = 0; k < count; ++k) {
    const Index i = basic.active[static_cast<std::size_t>(k)];
    inside[static_cast<std::size_t>(i)] = 1;
    if (scaled[k] < -tolerance * largest) basic.violated.push_back(i);
  }
  for (Index i = 0; i < basic.w.size(); ++i)
    if (inside[static_cast<std::size_t>(i)] == 0 && basic.w[i] < -tolerance * scale[i])
      basic.violated.push_back(i);
  std::sort(basic.violated.begin(), basic.violated.end());
}

/// One step of refinement on the residual that the test for violations needs anyway.
Basic solve_basic(LazyColumns &columns, const Vector &q, std::vector<Index> active,
                  double tolerance) {
  Basic basic;
  basic.active = std::move(active);
  columns.require(basic.active);
  const Matrix block = columns.block(basic.active);
  const Vector diagonal = block.diagonal();
  const Eigen::LLT<Matrix> cholesky(block);
  basic.regular = basic.active.empty() || cholesky.info() == Eigen::Success;
  if (!basic.regular) return basic;
  if (!basic.active.empty()) {
    const Vector right = q(basic.active);
    basic.x = -cholesky.solve(right);
    basic.x -= cholesky.solve(Vector(block.selfadjointView<Eigen::Lower>() * basic.x + right));
  }
  auto [product, sizes] = columns.multiply(basic.active, basic.x);
  basic.w = product + q;
  find_violations(basic, diagonal, sizes + q.cwiseAbs(), tolerance);
  return basic;
}

std::vector<Index> exchanged(const Basic &basic, const std::vector<Index> &which) {
  std::vector<Index> result;
  std::set_symmetric_difference(basic.active.begin(), basic.active.end(), which.begin(),
                                which.end(), std::back_inserter(result));
  return result;
}

std::vector<Index> checked(const Vector &q, std::vector<Index> start) {
  if (!q.allFinite()) throw failure("LCP: the right-hand side is not finite");
  std::sort(start.begin(), start.end());
  start.erase(std::unique(start.begin(), start.end()), start.end());
  if (!start.empty() && (start.front() < 0 || start.back() >= q.size()))
    throw failure("LCP: the first guess names an entry that does not exist");
  return start;
}

LcpResult finish(const Basic &basic, const Vector &q, LcpResult result) {
  result.active = basic.active;
  result.x = Vector::Zero(q.size());
  result.w = basic.w;
  if (basic.x.size() > 0) result.x(basic.active) = basic.x.cwiseMax(0.0);
  return result;
}

} // namespace

LcpResult solve_lcp(const ColumnSource &columns, const Vector &q, const std::vector<Index> &start,
                    const LcpOptions &options) {
  // Block steps without a new least number of violations before single pivots take over.
  constexpr int patience = 10;
  LazyColumns h(columns, q.size());
  LcpResult result;
  std::vector<Index> active = checked(q, start);
  const int limit =
      options.max_iterations > 0 ? options.max_iterations : 50 + 10 * static_cast<int>(q.size());
  std::set<std::vector<Index>> seen;
  std::size_t fewest = static_cast<std::size_t>(q.size()) + 1;
  int unrewarded = 0;
  bool single = false;
  for (;;) {
    const Basic basic = solve_basic(h, q, active, options.tolerance);
    ++result.iterations;
    result.columns = h.count();
    if (!basic.regular) {
      result.reason = "the block of H of " + std::to_string(active.size()) +
                      " active entries is not positive definite: dependent constraints or an "
                      "inexact H";
      return result;
    }
    if (basic.violated.empty()) {
      result.converged = true;
      result.reason = "no violation left";
      return finish(basic, q, std::move(result));
    }
    if (result.iterations >= limit) {
      result.reason = std::to_string(basic.violated.size()) + " violations left after " +
                      std::to_string(limit) +
                      " steps: raise the limit or the tolerance, or start closer to the solution";
      return finish(basic, q, std::move(result));
    }
    if (basic.violated.size() < fewest) {
      fewest = basic.violated.size();
      unrewarded = 0;
      single = false;
    } else if (!single) {
      single = seen.contains(active) || ++unrewarded > patience;
    }
    if (single)
      ++result.backup_steps;
    else
      seen.insert(active);
    active = exchanged(basic, single ? std::vector<Index>{basic.violated.front()} : basic.violated);
  }
}

} // namespace rbvi
