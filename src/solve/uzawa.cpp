// Niakh (2022): (3.24), (3.33), (3.34).
#include "rbvi/method/uzawa.hpp"

#include "rbvi/par/collective.hpp"
#include "rbvi/solve/methods.hpp"
#include "rbvi/solve/vectors.hpp"

#include <cmath>

namespace rbvi {

namespace {

/// The problem of method/uzawa.hpp over the ranks: linear solves with A, and what vectors these
/// need.
class UzawaBody {
public:
  UzawaBody(KSP ksp, const DistributedContact &contact, Mat w_product, Vec u)
      : ksp_(ksp), contact_(contact), w_product_(w_product), u_(u), load_(like(u)),
        dual_(like(contact.g.get())), image_(like(contact.g.get())) {}

  UzawaProblem problem(Vec f) {
    solve_linear(ksp_, f, u_);
    RBVI_CALL(MatMult(contact_.b.get(), u_, image_.get()));
    RBVI_CALL(VecAYPX(image_.get(), -1, contact_.g.get()));
    return {.times_h = [this](const Vector &x) { return times_h(x); },
            .q = LocalValues(image_.get()).get(),
            .projection = [this](const Vector &x) { return admissible(contact_.laws, x); },
            .dot = [this](const Vector &x, const Vector &y) { return dot(x, y); },
            .sizes =
                [this](const Vector &x) {
                  const Vector normal = normal_part(contact_.laws, x);
                  return std::array{size(normal), size(x - normal)};
                },
            .first = LocalValues(contact_.weights.get()).get()};
  }
  /// u = A^-1 (F - B^T x).
  void move(Vec f, const Vector &x) {
    press(x);
    RBVI_CALL(VecAYPX(load_.get(), -1, f));
    solve_linear(ksp_, load_.get(), u_);
  }
  Vec multipliers() const { return dual_.get(); } ///< that moved last

private:
  void press(const Vector &x) {
    LocalValues(dual_.get()).get() = x;
    RBVI_CALL(MatMultTranspose(contact_.b.get(), dual_.get(), load_.get()));
  }
  Vector times_h(const Vector &x) {
    press(x);
    solve_linear(ksp_, load_.get(), u_);
    RBVI_CALL(MatMult(contact_.b.get(), u_, image_.get()));
    return LocalValues(image_.get()).get();
  }
  double dot(const Vector &x, const Vector &y) const {
    std::array<double, 1> sum{x.dot(y)};
    over_ranks(PetscObjectComm(reinterpret_cast<PetscObject>(dual_.get())), MPI_SUM, sum);
    return sum[0];
  }
  double size(const Vector &x) {
    LocalValues(dual_.get()).get() = x;
    RBVI_CALL(MatMult(w_product_, dual_.get(), image_.get()));
    return std::sqrt(dot(x, LocalValues(image_.get()).get()));
  }

  KSP ksp_;
  const DistributedContact &contact_;
  Mat w_product_;
  Vec u_;
  Handle<Vec> load_, dual_, image_;
};

} // namespace

MethodResult solve_uzawa(KSP ksp, const DualLayout &layout, const DistributedContact &contact,
                         Vec f, Mat w_product, const UzawaOptions &options) {
  MethodResult result;
  result.free_u = like(f);
  UzawaBody body(ksp, contact, w_product, result.free_u.get());
  const UzawaResult found = solve_uzawa(body.problem(f), options);
  body.move(f, found.x);
  result.lambda = on_every_rank(layout, body.multipliers());
  result.iterations = found.iterations;
  result.converged = found.converged;
  result.reason = result.converged
                      ? "relative change of lambda below -uzawa_tolerance"
                      : "no convergence in -uzawa_max_iterations iterations: raise it, or try "
                        "-uzawa_accelerated or -hf_method active_set";
  return result;
}

} // namespace rbvi
