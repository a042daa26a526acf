// Queries where contact follows the displacement: the condition is linearised at the states of the
// iteration on the contact interfaces, and the body answers by its compliance on the contact dofs,
// so that the multipliers are those of the full problem.
#include "model_compliance.hpp"

#include "rbvi/contact/following.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/local_fit.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/rom/law/law_solver.hpp"

namespace rbvi {

namespace {

/// Of the answer from the undeformed body.
double distance_from_rest(const NonlinearContact &problem, const NonlinearResult &found,
                          const NonlinearOptions &options) {
  if (!bounds_follow_pressure(problem.laws)) return 0;
  const NonlinearResult other = solve_nonlinear(problem, {problem.undeformed, {}}, options);
  return other.converged ? distance_of_answers(found.x, other.x) : 0;
}

} // namespace

/// From what the samples predict, or the last query where that is asked for; else, and where there
/// are several answers, from the undeformed body.
NonlinearStart LawSolver::following_start(const FullMu &all_parameters) const {
  const Vector here = parts_of_box(scene_.parameters, all_parameters);
  NonlinearStart start{{}, by_rule_ ? Vector() : start_at(here)};
  if (start.x.size() == 0)
    start.state = undeformed(contact_, scene_, all_parameters);
  else if (options_.warm && last_state_.size() > 0)
    start.state = last_state_;
  else
    start.state = local_fit(model_.law->states, samples_, here);
  return start;
}

ReducedAnswer LawSolver::solve_following(const FullMu &all_parameters) {
  ReducedAnswer answer;
  if (compliance_->set(term_coefficients(all_parameters, {})) && nodal_compliance_)
    nodal_compliance_->forget();
  at_mu_.set(all_parameters);
  Vector load; // half response to it
  NonlinearContact problem{.compliance = *compliance_,
                           .free = Vector::Zero(compliance_->size()),
                           .undeformed = undeformed(contact_, scene_, all_parameters),
                           .laws = laws_at(columns_, contact_, all_parameters),
                           .w_product = w_product_};
  if (at_mu_.has_load()) {
    load = at_mu_.half_response(at_mu_.load());
    problem.free = model_.contact_trace * at_mu_.transposed_half_response(load);
  }
  NonlinearOptions options{.economical = true};
  if (!nodal_compliance_ && has_curvature(contact_) && !problem.laws.has_tangents())
    options.tolerance = 1e-8; // the change after it is of second order
  FollowedContact followed{
      .contact = contact_, .mu = all_parameters, .rows = nodal_is_identity_ ? nullptr : &nodal_};
  NonlinearResult found =
      rbvi::solve_following(followed, nodal_compliance_ ? &*nodal_compliance_ : nullptr, problem,
                            following_start(all_parameters), options);
  if (!(found.residual <= largest_residual))
    throw failure("the law of contact and friction is met to " + short_number(found.residual) +
                  " only: reduce again with more training parameters");
  if (options_.looks_for_others) answer.to_other = distance_from_rest(problem, found, options);
  answer.contact = std::move(followed.operators);
  assemble_nodal(contact_, all_parameters, {found.state}, followed.at_dual_dofs(found.x),
                 answer.contact);
  answer.reaction = std::move(found.reaction);
  answer.energy = 0.5 * (answer.reaction.dot(problem.free - found.state) - load.squaredNorm());
  answer.u = moved_by(answer.reaction);
  if (load.size() > 0) answer.u += at_mu_.transposed_half_response(load);
  answer.residual = found.residual;
  answer.iterations = found.steps;
  answer.load_steps = found.load_steps;
  answer.contraction = found.rate;
  answer.lambda = found.x;
  answer.start = found.start;
  last_state_ = found.state;
  return answer;
}

} // namespace rbvi
