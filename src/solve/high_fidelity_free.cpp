// HighFidelity with bodies that contact alone holds: what their springs are relaxed at is found
// such that forces balance.
#include "contact_method.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/method/balance.hpp"
#include "rbvi/method/several_answers.hpp"
#include "rbvi/par/collective.hpp"

namespace rbvi {

namespace {

/// On bodies that contact alone holds.
struct FreeForces {
  Matrix held;  ///< Problem::held_by()
  Vector terms; ///< sums of the sizes of the loads, as Problem::pushed()
};

FreeForces balanced_forces(const Problem &problem, const Operators &op) {
  const auto [load, terms] = problem.pushed(op.mu);
  FreeForces forces{problem.held_by(op), terms};
  const Vector left = unbalanced_load(op.laws, forces.held, load, terms);
  if (left.norm() > 0)
    throw failure(describe(problem.free_bodies(), problem.scene().dim, left) +
                  ", and is pushed where no contact and no friction can hold it");
  return forces;
}

} // namespace

Matrix unresisted_motions(const Problem &problem, const Operators &op) {
  return unresisted_motions(op.laws, balanced_forces(problem, op).held);
}

MethodResult HighFidelity::run_free(const Mu &mu, const Operators &op, ContactRows rows,
                                    const Vector &slip, const Solved *near) {
  const std::vector<FreeBody> &bodies = problem_.free_bodies();
  const int dim = problem_.scene().dim;
  Operators all;
  collectively(problem_.comm(), [&] { problem_.assemble_contact(mu, all); });
  // Of several answers with friction that from rest is taken, whatever was solved before.
  const Vector start = near == nullptr || bounds_follow_pressure(all.laws)
                           ? Vector(Vector::Zero(motions_of(bodies)))
                           : near->beta;
  const auto [held, terms] = balanced_forces(problem_, all);
  Matrix lengths(start.size(), start.size()); // of the springs by each motion
  Index k = 0;
  for (const Handle<Vec> &motion :
       rigid_motions(bodies, problem_.scene(), op.mu, problem_.mesh(), problem_.dofs()))
    lengths.col(k++) = spring_lengths(bodies, motion.get());
  const double stiffness =
      lengths.norm() * spring_coefficients(bodies, problem_.scene(), op.mu).cwiseAbs().maxCoeff();
  MethodResult result;
  std::optional<Solved> last; // of the springs before
  int iterations = 0;
  const Balance balance = find_balance(start, [&](const Vector &beta) {
    problem_.relax_springs(beta);
    result = run(mu, op, slip, last ? &*last : near, last.has_value());
    iterations += result.iterations;
    last = method_->kept(result);
    const Vector forces = forces_on_motions(all.laws, held, terms, result.lambda);
    return SpringState{spring_lengths(bodies, result.free_u.get()), forces.maxCoeff() / stiffness};
  });
  problem_.relax_springs(Vector::Zero(start.size()));
  if (balance.flies)
    throw failure(describe(bodies, dim, lu_solve(lengths, balance.excess)) +
                  ", and is pushed on where no contact and no friction can hold it");
  if (!balance.converged) {
    const std::string moved = describe(bodies, dim, lu_solve(lengths, balance.excess));
    throw failure("the forces on bodies that contact alone holds do not balance in " +
                  std::to_string(balance.solves) + " solves: " + moved +
                  (moved.empty() ? "" : ": ") +
                  "give them friction or displacements that hold them, or stiffnesses less far "
                  "apart");
  }
  if (rows == ContactRows::all) static_cast<ContactOperators &>(all) = op;
  const Matrix loose = loose_motions(all.laws, problem_.held_by(all), result.lambda);
  if (loose.cols() > 0)
    throw failure(describe(bodies, dim, loose) +
                  " at no cost at the answer, where no contact and no friction holds it");
  result.iterations = iterations;
  result.beta = balance.beta;
  return result;
}

} // namespace rbvi
