#include "rbvi/core/error.hpp"
#include "rbvi/solve/methods.hpp"

#include <cmath>

namespace rbvi {

namespace {

/// Largest eigenvalue of B A^-1 B^T by power iterations, to 1 %, rounded up by as much.
double largest_eigenvalue(KSP ksp, const Trace &trace, const Operators &op, Vec scratch) {
  Handle<Vec> load;
  RBVI_CALL(VecDuplicate(scratch, load.put()));
  Vector x(op.g.size());
  for (Index i = 0; i < op.laws.nodes(); ++i) {
    const auto node = static_cast<std::size_t>(i);
    x[op.laws.normal[node]] = op.weights[i];
    if (op.laws.has_tangent(i))
      x.segment(op.laws.tangent[node], op.laws.tangents).setConstant(op.weights[i]);
  }
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

/// (3.19): the changes of the normal and of the tangential part, each against its own size.
bool small_change(const SparseMatrix &w, const NodeLaws &laws, const Vector &change,
                  const Vector &lambda, double tolerance) {
  const Vector normal = normal_part(laws, change), of_lambda = normal_part(laws, lambda);
  const auto small = [&](const Vector &part, const Vector &whole) {
    return std::sqrt(part.dot(w * part)) <= tolerance * std::sqrt(whole.dot(w * whole));
  };
  return small(normal, of_lambda) && small(change - normal, lambda - of_lambda);
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
    const Vector next = admissible(op.laws, extrapolated + step * violation);
    const Vector change = next - lambda;
    const bool small = small_change(w_product, op.laws, change, next, options.uzawa_tolerance);
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
  for (Index i = 0; i < op.laws.nodes(); ++i)
    if (lambda[op.laws.normal[static_cast<std::size_t>(i)]] > 0) result.active.push_back(i);
  result.lambda = std::move(lambda);
  result.reason = result.converged
                      ? "relative change of lambda below -uzawa_tolerance"
                      : "no convergence in -uzawa_max_iterations iterations: raise it, or try "
                        "-uzawa_accelerated or -hf_method active_set";
  return result;
}

} // namespace rbvi
