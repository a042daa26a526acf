#include "law_methods.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/model/free_bodies.hpp"

#include <algorithm>

namespace rbvi {

bool has_several_answers(const ReducedModel &model) {
  return model.made.histories.contains("self_check/other");
}

NodeLawSolver::NodeLawSolver(const ReducedModel &model, const Scene &scene, const Contact &contact,
                             const QueryOptions &options, bool by_rule)
    : model_(model), scene_(scene), by_rule_(by_rule || rests_at_start(model, scene)),
      looks_for_others_(options.looks_for_others || by_rule), problem_(model, scene, contact),
      starts_(scene.parameters, model.contact.law->starts_mu, options.warm) {}

void NodeLawSolver::solve_at_nodes(const LawAtMu &law, ReducedAnswer &answer) {
  ReducedContact &contact = problem_.contact();
  Vector start = answer.start;
  if (start.size() == 0)
    start = starts_.at([&] { return starts_.fit(model_.contact.law->starts, answer.mu); });
  for (Index i = 0; i < start.size(); ++i)
    if (start[i] > 0 && !contact.faces(i)) start[i] = 0;
  // Where springs of free bodies change, an answer is continued from the one before.
  const bool continues = answer.motions && answer.start.size() > 0;
  FrictionSolver &friction = problem_.friction();
  FrictionAnswer found = friction.answer(law.q, start, by_rule_ && !continues);
  if (!found.converged)
    throw failure("the law of contact and friction is met to " + short_number(found.residual) +
                  " only: " + found.reason);
  if (answer.motions) answer.motions->slope = friction.change(law.by_beta, false);
  if (!answer.motions)
    answer.to_other = distance_seen(friction, found, looks_for_others_);
  else if (looks_for_others_)
    balanced_ = {law.q, found};
  answer.energy = 0.5 * (found.x.dot(found.w - law.q) - law.load.squaredNorm());
  answer.iterations += found.iterations;
  answer.lambda = std::move(found.x);
  answer.left = std::move(found.w);
  answer.start = std::move(found.start);
}

ReducedAnswer NodeLawSolver::solve(const FullMu &mu, Relaxed relaxed) {
  ReducedAnswer answer = std::move(relaxed.before);
  answer.iterations = 0;
  solve_at_nodes(problem_.at(mu, answer, {}, relaxed.beta), answer);
  return answer;
}

void NodeLawSolver::displace(ReducedAnswer &answer) {
  problem_.displace(answer);
  if (balanced_)
    answer.to_other = distance_seen_from(
        [&](const std::vector<Index> &which) {
          return problem_.contact().condensed_columns(which);
        },
        balanced_->first, problem_.friction().laws(), balanced_->second, answer.motions->held);
  balanced_.reset();
  starts_.keep(answer.start);
}

std::optional<ReducedAnswer> NodeLawSolver::near(const ReducedAnswer &from, const FullMu &mu) {
  if (auto last = problem_.take_friction()) near_ = std::move(last);
  ReducedAnswer answer;
  answer.beta = from.beta;
  const LawAtMu &law = problem_.at(mu, answer, {}, answer.beta);
  const Vector left = problem_.left(law, from.lambda); // with the springs as they were
  NearAnswer found = near_->near(left, law.laws);
  if (answer.motions) {
    const FreeMotions &motions = *answer.motions;
    const Matrix slope = near_->change(law.by_beta, true);
    const Vector change = lu_solve(motions.held.transpose() * slope,
                                   motions.load - motions.held.transpose() * found.x);
    if (!change.allFinite()) throw failure("nothing holds a body at the answer");
    answer.beta += change;
    found = near_->near(left + law.by_beta * change, law.laws);
    problem_.at(mu, answer, {}, answer.beta);
  }
  answer.energy = 0.5 * (found.x.dot(found.w - law.q) - law.load.squaredNorm()) +
                  energy_of_springs(model_, scene_, answer);
  answer.passes_kink = !found.same_states;
  answer.lambda = std::move(found.x);
  answer.start = std::move(found.start);
  problem_.displace(answer);
  return answer;
}

std::map<MultiplierReduction, LawSolverMaker> &law_solvers() {
  static std::map<MultiplierReduction, LawSolverMaker> list;
  return list;
}

std::unique_ptr<QueryMethod> law_solver(const ReducedModel &model, const Scene &scene,
                                        const Contact &contact, const QueryOptions &options) {
  if (!model.contact.law) throw bad_input("the model has no law of contact at nodes");
  const bool follows = follows_state(contact), on_functions = model.contact.law->on_functions();
  if (follows && on_functions)
    throw bad_input("contact that follows the displacement is reduced to a law at all nodes");
  if (on_functions)
    return entered(law_solvers(), model.contact.law->reduction,
                   "-multiplier_reduction collocated")(model, scene, contact, options);
  const bool by_rule = !options.warm && has_several_answers(model);
  if (follows) return std::make_unique<FollowingSolver>(model, scene, contact, options, by_rule);
  return std::make_unique<NodeLawSolver>(model, scene, contact, options, by_rule);
}

} // namespace rbvi
