#include "rbvi/model/free_bodies.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/method/balance.hpp"
#include "rbvi/method/starts.hpp"
#include "rbvi/model/law_solver.hpp"

#include <algorithm>
#include <utility>

namespace rbvi {

double energy_of_springs(const ReducedModel &model, const Scene &scene,
                         const ReducedAnswer &answer) {
  if (answer.beta.size() == 0) return 0;
  return spring_coefficients(model, scene, answer.mu).dot(answer.beta.cwiseAbs2()) / 2;
}

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
  ReducedAnswer answer;
  int iterations = 0;
  const Vector beta = start_of(model, scene, mu);
  const HeldBodies bodies{.solve =
                              [&](const Vector &at) {
                                try {
                                  answer = method.solve(mu, {at, std::move(answer)});
                                } catch (const Error &) {
                                  answer = {}; // of which the solve that failed has taken parts
                                  throw;
                                }
                                iterations += answer.iterations;
                                // As A_N^-1 springs are rigid motions.
                                const FreeMotions &motions = *answer.motions;
                                return HeldAnswer{&motions, &answer.lambda,
                                                  at + motions.load -
                                                      motions.held.transpose() * answer.lambda};
                              },
                          .describe = [](const Matrix &) { return std::string("a body can move"); },
                          .lengths = Matrix::Identity(beta.size(), beta.size()),
                          .stiffness = 1,
                          .advice = "reduce again with more training parameters"};
  const Vector balanced = balance_bodies(beta, bodies);
  method.displace(answer);
  answer.iterations = iterations;
  answer.beta = balanced;
  answer.energy += energy_of_springs(model, scene, answer);
  return answer;
}

} // namespace rbvi
