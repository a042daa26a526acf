#include "rbvi/model/free_bodies.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/method/balance.hpp"
#include "rbvi/method/starts.hpp"
#include "rbvi/model/law_solver.hpp"

#include <algorithm>
#include <utility>

namespace rbvi {

FreeMotions free_motions_at(const BodyAtMu &body, const Matrix &motions, Matrix held,
                            NodeLaws laws) {
  const Vector load = body.given_load();
  return {std::move(laws), std::move(held), motions.transpose() * load,
          motions.cwiseAbs().transpose() * load.cwiseAbs()};
}

bool rests_at_start(const ReducedModel &model, const Scene &scene) {
  return model.body.springs.size() > 0 &&
         std::ranges::any_of(scene.contacts, [](const ContactRecipe &contact) {
           return contact.friction != FrictionLaw::none;
         });
}

namespace {

/// What the samples predict.
Vector start_of(const ReducedModel &model, const Scene &scene, const FullMu &mu) {
  const Matrix &of_samples = model.body.motions, &at = model.made.trained_mu;
  if (rests_at_start(model, scene)) return Vector::Zero(of_samples.rows());
  if (at.cols() != of_samples.cols()) // before the model is complete
    return of_samples.rowwise().mean();
  return Neighbours(scene.parameters, at).fit(of_samples, mu);
}

} // namespace

ReducedAnswer solve_balanced(QueryMethod &method, const ReducedModel &model, const Scene &scene,
                             const FullMu &mu) {
  if (model.body.springs.size() == 0) {
    ReducedAnswer answer = method.solve(mu, {});
    method.displace(answer);
    return answer;
  }
  const std::string unheld =
      "a body that contact alone holds is pushed where no contact and no friction can hold it";
  const Vector start = start_of(model, scene, mu);
  ReducedAnswer answer;
  int iterations = 0;
  double to_other = 0;
  const Balance balance = find_balance(start, [&](const Vector &beta) {
    try {
      answer = method.solve(mu, {beta, std::move(answer)});
    } catch (const Error &) {
      answer = {}; // of which the solve that failed has taken parts
      throw;
    }
    iterations += answer.iterations;
    to_other = std::max(to_other, answer.to_other);
    const FreeMotions &motions = *answer.motions;
    if (iterations == answer.iterations &&
        unbalanced_load(motions.laws, motions.held, motions.load, motions.terms).norm() > 0)
      throw failure(unheld);
    // Their lengths are beta and what forces leave, as A_N^-1 springs are rigid motions.
    return SpringState{
        beta + motions.load - motions.held.transpose() * answer.lambda,
        forces_on_motions(motions.laws, motions.held, motions.terms, answer.lambda).maxCoeff(),
        motions.slope.size() > 0 ? Matrix(-motions.held.transpose() * motions.slope) : Matrix()};
  });
  if (balance.flies) throw failure(unheld);
  if (!balance.converged)
    throw failure("the forces on a body that contact alone holds do not balance in " +
                  std::to_string(balance.solves) +
                  " solves: reduce again with more training parameters");
  if (loose_motions(answer.motions->laws, answer.motions->held, answer.lambda).cols() > 0)
    throw failure("a body can move at no cost: no contact and no friction holds it at the answer");
  method.displace(answer);
  answer.iterations = iterations;
  answer.to_other = to_other;
  const Vector theta = spring_coefficients(model, scene, mu);
  answer.energy += theta.dot(balance.beta.cwiseAbs2()) / 2;
  return answer;
}

} // namespace rbvi
