#include "rbvi/core/error.hpp"
#include "rbvi/solve/methods.hpp"

#include <cmath>

namespace rbvi {

namespace {

/// Largest eigenvalue of B A^-1 B^T by power iterations, to 1 %, rounded up by as much.
double largest_eigenvalue(KSP ksp, const Trace &trace, const Operators &op, Vec scratch) {
  Handle<Vec> load;
  RBVI_CALL(VecDuplicate(scratch, load.put()));
  Vector x = op.weights.normalized();
  double estimate = 0;
  for (int k = 0; k < 100; ++k) {
    RBVI_CALL(VecZeroEntries(load.get()));
    const Vector reaction = op.b.transpose() * x;
    add_extension(trace, reaction, load.get());
    solve_linear(ksp, load.get(), scratch);
    x = op.b * restrict_to(trace, scratch);
    const double previous = estimate;
    estimate = x.norm();
    x /= estimate;
    if (std::abs(estimate - previous) <= 1e-2 * estimate) break;
  }
  return 1.01 * estimate;
}

double w_norm(const SparseMatrix &w, const Vector &x) {
  return std::sqrt(x.dot(w * x));
}

} // namespace

MethodResult solve_uzawa(KSP ksp, const Trace &trace, const Operators &op,
                         const SparseMatrix &w_product, const HfOptions &options) {
  MethodResult result;
  RBVI_CALL(VecDuplicate(op.f, result.u.put()));
  Vec u = result.u.get();
  const double step =
      options.uzawa_step > 0 ? options.uzawa_step : 1 / largest_eigenvalue(ksp, trace, op, u);
  Vector lambda = Vector::Zero(op.g.size()), extrapolated = lambda;
  double momentum = 1;
  for (result.iterations = 1; result.iterations <= options.uzawa_max_iterations;
       ++result.iterations) {
    solve_linear(ksp, reaction_rhs(trace, op, extrapolated).get(), u);
    const Vector violation = op.b * restrict_to(trace, u) - op.g;
    const Vector next = (extrapolated + step * violation).cwiseMax(0);
    const Vector change = next - lambda;
    const double size = w_norm(w_product, next);
    const bool small = w_norm(w_product, change) <= options.uzawa_tolerance * size;
    if (small && (result.iterations > 1 || size == 0)) result.converged = true;
    if (options.uzawa_accelerated) {
      const bool overshot = (extrapolated - next).dot(change) > 0;
      const double grown = overshot ? 1 : (1 + std::sqrt(1 + 4 * momentum * momentum)) / 2;
      extrapolated = overshot ? next : Vector(next + (momentum - 1) / grown * change);
      momentum = grown;
    } else {
      extrapolated = next;
    }
    lambda = next;
    if (result.converged) break;
  }
  solve_linear(ksp, reaction_rhs(trace, op, lambda).get(), u);
  for (Index i = 0; i < lambda.size(); ++i)
    if (lambda[i] > 0) result.active.push_back(i);
  result.lambda = std::move(lambda);
  result.reason = result.converged
                      ? "relative change of lambda below -uzawa_tolerance"
                      : "no convergence in -uzawa_max_iterations iterations: raise it, or try "
                        "-uzawa_accelerated or -hf_method active_set";
  return result;
}

} // namespace rbvi
