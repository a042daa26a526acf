// HighFidelity with bodies that contact alone holds: what their springs are relaxed at is found
// such that forces balance.
#include "contact_method.hpp"

#include "rbvi/method/balance.hpp"
#include "rbvi/method/several_answers.hpp"
#include "rbvi/par/collective.hpp"

namespace rbvi {

namespace {

/// `op`: with all rows of B.
FreeMotions motions_at(const Problem &problem, const Operators &op) {
  auto [load, terms] = problem.pushed(op.mu);
  return {op.laws, problem.held_by(op), std::move(load), std::move(terms)};
}

MotionText text_of(const Problem &problem) {
  return [&](const Matrix &motions) {
    return describe(problem.free_bodies(), problem.scene().dim, motions);
  };
}

} // namespace

Matrix unresisted_motions(const Problem &problem, const Operators &op) {
  const FreeMotions motions = motions_at(problem, op);
  check_held(motions, text_of(problem));
  return unresisted_motions(op.laws, motions.held);
}

MethodResult HighFidelity::run_free(const Mu &mu, const Operators &op, const Vector &slip,
                                    const Solved *near) {
  const std::vector<FreeBody> &bodies = problem_.free_bodies();
  Operators all;
  collectively(problem_.comm(), [&] { problem_.assemble_contact(mu, all); });
  const FreeMotions motions = motions_at(problem_, all);
  check_held(motions, text_of(problem_));
  // Of several answers with friction that from rest is taken, whatever was solved before.
  const Vector start = near == nullptr || bounds_follow_pressure(all.laws)
                           ? Vector(Vector::Zero(motions_of(bodies)))
                           : near->beta;
  Matrix lengths(start.size(), start.size());
  Index k = 0;
  for (const Handle<Vec> &motion :
       rigid_motions(bodies, problem_.scene(), op.mu, problem_.mesh(), problem_.dofs()))
    lengths.col(k++) = spring_lengths(bodies, motion.get());
  const double stiffness =
      lengths.norm() * spring_coefficients(bodies, problem_.scene(), op.mu).cwiseAbs().maxCoeff();
  MethodResult result;
  std::optional<Solved> last; // of the springs before
  int iterations = 0;
  const auto solve = [&](const Vector &beta) {
    problem_.relax_springs(beta);
    result = run(mu, op, slip, last ? &*last : near, last.has_value());
    iterations += result.iterations;
    last = method_->kept(result);
    return HeldAnswer{&motions, &result.lambda, spring_lengths(bodies, result.free_u.get())};
  };
  result.beta = balance_bodies(
      start, {solve, text_of(problem_), lengths, stiffness,
              "give them friction or displacements that hold them, or stiffnesses less far apart"});
  problem_.relax_springs(Vector::Zero(start.size()));
  result.iterations = iterations;
  return result;
}

} // namespace rbvi
