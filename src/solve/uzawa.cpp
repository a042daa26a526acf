#include "rbvi/core/error.hpp"
#include "rbvi/solve/methods.hpp"
#include "rbvi/solve/vectors.hpp"

#include <cmath>

namespace rbvi {

namespace {

/// u = A^-1 (F - B^T lambda).
void solve_body(KSP ksp, const DistributedContact &contact, Vec f, Vec lambda, Vec u) {
  const Handle<Vec> rhs = like(f);
  RBVI_CALL(MatMultTranspose(contact.b.get(), lambda, rhs.get()));
  RBVI_CALL(VecAYPX(rhs.get(), -1, f));
  solve_linear(ksp, rhs.get(), u);
}

/// Largest eigenvalue of B A^-1 B^T by power iterations, to 1 %, rounded up by as much.
double largest_eigenvalue(KSP ksp, const DistributedContact &contact, Vec scratch) {
  const Handle<Vec> load = like(scratch), x = like(contact.g.get());
  RBVI_CALL(VecCopy(contact.weights.get(), x.get()));
  RBVI_CALL(VecNormalize(x.get(), nullptr));
  double estimate = 0;
  for (int k = 0; k < 100; ++k) {
    RBVI_CALL(MatMultTranspose(contact.b.get(), x.get(), load.get()));
    solve_linear(ksp, load.get(), scratch);
    RBVI_CALL(MatMult(contact.b.get(), scratch, x.get()));
    const double previous = estimate;
    RBVI_CALL(VecNormalize(x.get(), &estimate));
    if (std::abs(estimate - previous) <= 1e-2 * estimate) break;
  }
  return 1.01 * estimate;
}

/// When the changes of the normal and of the tangential multipliers, each against its own size in
/// W, are small (3.19).
class SmallChange {
public:
  SmallChange(Mat w, const NodeLaws &laws, double tolerance)
      : w_(w), laws_(laws), tolerance_(tolerance) {
    RBVI_CALL(MatCreateVecs(w, part_.put(), product_.put()));
  }

  bool operator()(Vec change, Vec lambda) const {
    return is_small(change, lambda, true) && is_small(change, lambda, false);
  }

private:
  double size(Vec v, bool normal) const {
    RBVI_CALL(VecCopy(v, part_.get()));
    keep(normal, part_.get());
    RBVI_CALL(MatMult(w_, part_.get(), product_.get()));
    return std::sqrt(dot(part_.get(), product_.get()));
  }
  /// The normal multipliers alone, or the others.
  void keep(bool normal, Vec v) const {
    LocalValues values(v);
    const Vector of_normal = normal_part(laws_, values.get());
    values.get() = normal ? of_normal : Vector(values.get() - of_normal);
  }
  bool is_small(Vec change, Vec lambda, bool normal) const {
    return size(change, normal) <= tolerance_ * size(lambda, normal);
  }

  Mat w_;
  const NodeLaws &laws_;
  double tolerance_;
  Handle<Vec> part_, product_;
};

/// next <- the projection of `extrapolated` + step (B u - G) onto the laws.
void project_step(const DistributedContact &contact, double step, Vec u, Vec extrapolated,
                  Vec next) {
  RBVI_CALL(MatMult(contact.b.get(), u, next));
  RBVI_CALL(VecAXPY(next, -1, contact.g.get()));
  RBVI_CALL(VecAYPX(next, step, extrapolated));
  LocalValues values(next);
  values.get() = admissible(contact.laws, values.get());
}

/// Nesterov's extrapolation beyond `next`, started again when it overshoots. `change`: from the
/// multipliers before.
void extrapolate(Vec next, Vec change, double &momentum, Vec extrapolated) {
  const bool overshot = dot(extrapolated, change) > dot(next, change);
  const double grown = overshot ? 1 : (1 + std::sqrt(1 + 4 * momentum * momentum)) / 2;
  RBVI_CALL(VecWAXPY(extrapolated, overshot ? 0 : (momentum - 1) / grown, change, next));
  momentum = grown;
}

} // namespace

MethodResult solve_uzawa(KSP ksp, const DualLayout &layout, const DistributedContact &contact,
                         Vec f, Mat w_product, const HfOptions &options) {
  MethodResult result;
  result.free_u = like(f);
  Vec u = result.free_u.get();
  const double step =
      options.uzawa_step > 0 ? options.uzawa_step : 1 / largest_eigenvalue(ksp, contact, u);
  const SmallChange small_change(w_product, contact.laws, options.uzawa_tolerance);
  const Handle<Vec> change = like(contact.g.get()), extrapolated = like(contact.g.get());
  Handle<Vec> lambda = like(contact.g.get()), next = like(contact.g.get());
  RBVI_CALL(VecZeroEntries(lambda.get()));
  RBVI_CALL(VecZeroEntries(extrapolated.get()));
  double momentum = 1;
  for (result.iterations = 1; result.iterations <= options.uzawa_max_iterations;
       ++result.iterations) {
    solve_body(ksp, contact, f, extrapolated.get(), u);
    project_step(contact, step, u, extrapolated.get(), next.get());
    RBVI_CALL(VecWAXPY(change.get(), -1, lambda.get(), next.get()));
    const bool small = small_change(change.get(), next.get());
    result.converged = small && (result.iterations > 1 || norm(next.get()) == 0);
    if (options.uzawa_accelerated)
      extrapolate(next.get(), change.get(), momentum, extrapolated.get());
    else
      RBVI_CALL(VecCopy(next.get(), extrapolated.get()));
    std::swap(lambda, next);
    if (result.converged) break;
  }
  solve_body(ksp, contact, f, lambda.get(), u);
  result.lambda = on_every_rank(layout, lambda.get());
  result.reason = result.converged
                      ? "relative change of lambda below -uzawa_tolerance"
                      : "no convergence in -uzawa_max_iterations iterations: raise it, or try "
                        "-uzawa_accelerated or -hf_method active_set";
  return result;
}

} // namespace rbvi
