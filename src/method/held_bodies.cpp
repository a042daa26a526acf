#include "rbvi/core/error.hpp"
#include "rbvi/method/balance.hpp"

namespace rbvi {

void check_held(const FreeMotions &motions, const MotionText &describe) {
  const Vector left = unbalanced_load(motions.laws, motions.held, motions.load, motions.terms);
  if (left.norm() > 0)
    throw failure(describe(left) + ", and is pushed where no contact and no friction can hold it");
}

Vector balance_bodies(Vector beta, const HeldBodies &bodies) {
  HeldAnswer last{};
  const Balance balance = find_balance(std::move(beta), [&](const Vector &at) {
    const bool first = last.motions == nullptr;
    last = bodies.solve(at);
    const auto &[laws, held, load, terms, slope] = *last.motions;
    if (first) check_held(*last.motions, bodies.describe);
    return SpringState{last.lengths,
                       forces_on_motions(laws, held, terms, *last.x).maxCoeff() / bodies.stiffness,
                       slope.size() > 0 ? Matrix(-held.transpose() * slope) : Matrix()};
  });
  const auto motion = [&] { return bodies.describe(lu_solve(bodies.lengths, balance.excess)); };
  if (balance.flies)
    throw failure(motion() + ", and is pushed on where no contact and no friction can hold it");
  if (!balance.converged) {
    const std::string moved = motion();
    throw failure("the forces on bodies that contact alone holds do not balance in " +
                  std::to_string(balance.solves) + " solves: " + moved +
                  (moved.empty() ? "" : ": ") + bodies.advice);
  }
  const Matrix loose = loose_motions(last.motions->laws, last.motions->held, *last.x);
  if (loose.cols() > 0)
    throw failure(bodies.describe(loose) +
                  " at no cost at the answer, where no contact and no friction holds it");
  return balance.beta;
}

} // namespace rbvi
