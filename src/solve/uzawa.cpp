#include "rbvi/contact/support/support_outputs.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/solve/methods.hpp"

#include <cmath>

namespace rbvi {

namespace {

/// Largest eigenvalue of B A^-1 B^T by power iterations, to 1 %, rounded up by as much.
double largest_eigenvalue(KSP ksp, const Trace &trace, const Operators &op, Vec scratch) {
  Handle<Vec> load;
  RBVI_CALL(VecDuplicate(scratch, load.put()));
  Vector x = Vector::Ones(op.g.size());
  for (Index i = 0; i < x.size(); ++i)
    x[i] = op.weights[i % op.weights.size()];
  x.normalize();
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

/// Onto lambda_n >= 0 and then |lambda_tau| <= its bound, node by node (corrected (3.32)).
Vector admissible(const Operators &op, Vector lambda) {
  lambda.head(op.normal) = lambda.head(op.normal).cwiseMax(0);
  const Index components = lambda.size() / op.normal - 1;
  if (components == 0) return lambda;
  const Vector bounds = friction_bounds(op.bound, lambda.head(op.normal));
  for (Index i = 0; i < op.normal; ++i) {
    auto tangential = lambda.segment(op.normal + i * components, components);
    if (const double size = tangential.norm(); size > bounds[i]) tangential *= bounds[i] / size;
  }
  return lambda;
}

/// (3.19): the changes of the normal and of the tangential part, each against its own size.
bool small_change(const SparseMatrix &w, Index normal, const Vector &change, const Vector &lambda,
                  double tolerance) {
  const Vector wc = w * change, wl = w * lambda;
  const auto small = [&](Index first, Index count) {
    const double square = change.segment(first, count).dot(wc.segment(first, count));
    const double size = lambda.segment(first, count).dot(wl.segment(first, count));
    return std::sqrt(square) <= tolerance * std::sqrt(size);
  };
  return small(0, normal) && small(normal, lambda.size() - normal);
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
    const Vector next = admissible(op, extrapolated + step * violation);
    const Vector change = next - lambda;
    const bool small = small_change(w_product, op.normal, change, next, options.uzawa_tolerance);
    if (small && (result.iterations > 1 || (next.array() == 0).all())) result.converged = true;
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
  for (Index i = 0; i < op.normal; ++i)
    if (lambda[i] > 0) result.active.push_back(i);
  result.lambda = std::move(lambda);
  result.reason = result.converged
                      ? "relative change of lambda below -uzawa_tolerance"
                      : "no convergence in -uzawa_max_iterations iterations: raise it, or try "
                        "-uzawa_accelerated or -hf_method active_set";
  return result;
}

} // namespace rbvi
