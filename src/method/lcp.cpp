#include "rbvi/method/lcp.hpp"

#include "lazy_columns.hpp"
#include "pivoting.hpp"
#include "rbvi/core/error.hpp"

namespace rbvi {

namespace {

using namespace pivoting;

/// Violations are relative to the terms of their own row, and to the largest x in the scaling in
/// which H has a unit diagonal, so that neither units nor the sizes of basis functions matter.
BasicSolution solve_basis(LazyColumns &columns, const Vector &q, std::vector<Index> active,
                          double tolerance) {
  BasicSolution basic;
  basic.active = std::move(active);
  columns.require(basic.active);
  const Matrix block = columns.block(basic.active);
  const Vector diagonal = block.diagonal();
  Matrix lower = block;
  basic.regular = cholesky_in_place(lower);
  if (!basic.regular) return basic;
  if (!basic.active.empty()) {
    const Vector right = q(basic.active);
    basic.x = -cholesky_solve(lower, right);
    basic.x -= cholesky_solve(lower, block.selfadjointView<Eigen::Lower>() * basic.x + right);
  }
  auto [product, sizes] = columns.multiply(basic.active, basic.x);
  basic.w = product + q;
  const Vector scaled = basic.x.cwiseProduct(diagonal.cwiseSqrt());
  find_violations(basic, scaled, sizes + q.cwiseAbs(), tolerance);
  return basic;
}

LcpResult finish(const BasicSolution &basic, const Vector &q, LcpResult result) {
  result.active = basic.active;
  result.x = Vector::Zero(q.size());
  result.w = basic.w;
  if (basic.x.size() > 0) result.x(basic.active) = basic.x.cwiseMax(0.0);
  return result;
}

} // namespace

LcpResult solve_lcp(const ColumnSource &columns, const Vector &q, const std::vector<Index> &start,
                    const LcpOptions &options) {
  if (!q.allFinite()) throw failure("LCP: the right-hand side is not finite");
  LazyColumns h(columns, q.size());
  LcpResult result;
  std::vector<Index> active = checked_guess(start, q.size());
  const int limit =
      options.max_iterations > 0 ? options.max_iterations : 50 + 10 * static_cast<int>(q.size());
  Policy<std::vector<Index>, std::size_t> policy(/*patience=*/11);
  for (;;) {
    const BasicSolution basic = solve_basis(h, q, active, options.tolerance);
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
      result.reason = "every condition of contact holds";
      return finish(basic, q, std::move(result));
    }
    if (result.iterations >= limit) {
      result.reason = std::to_string(basic.violated.size()) + " violations left after " +
                      std::to_string(limit) +
                      " steps: raise the limit or the tolerance, or start closer to the solution";
      return finish(basic, q, std::move(result));
    }
    if (policy.after(active, basic.violated.size()) == Exchange::block) {
      active = exchanged(active, basic.violated);
    } else {
      ++result.backup_steps;
      active = exchanged(active, {basic.violated.front()});
    }
  }
}

} // namespace rbvi
