// Queries where contact follows the displacement: the condition is linearised at the states of the
// iteration on the contact interfaces, and the body answers by its compliance on the contact dofs,
// so that the multipliers are those of the full problem.
#include "law_methods.hpp"

#include "rbvi/contact/following.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/model/free_bodies.hpp"

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

FollowingSolver::FollowingSolver(const ReducedModel &model, const Scene &scene,
                                 const Contact &contact, const QueryOptions &options, bool by_rule)
    : model_(model), scene_(scene), contact_(contact), by_rule_(by_rule),
      looks_for_others_(options.looks_for_others || by_rule),
      columns_(laws_of_columns(contact, model.contact.dual_basis)), body_(model, scene),
      at_mu_(body_), evaluated_(model, scene, contact, body_),
      rows_are_identity_(model.contact.dual_basis.isIdentity(0)),
      w_product_(evaluated_.rows() * contact.w_product() * evaluated_.rows().transpose()),
      starts_(scene.parameters, model.contact.law->starts_mu, options.warm) {
  if (options.method == OnlineMethod::kacanov) steps_.method = NonlinearMethod::kacanov;
  const ContactInterface *nodal = nodal_interface(contact);
  if (nodal != nullptr && rows_are_identity_) nodal_.emplace(nodal->averages());
}

/// From what the samples predict, or the last query where that is asked for; else, and where there
/// are several answers, from the undeformed body.
Start FollowingSolver::start(const FullMu &mu) const {
  const NodalLaw &law = *model_.contact.law;
  Start start;
  if (!by_rule_)
    start = starts_.at([&] {
      return Start{starts_.fit(law.states, mu), starts_.fit(law.starts, mu)};
    });
  if (start.x.size() == 0) start.state = undeformed(contact_, scene_, mu);
  return start;
}

ReducedAnswer FollowingSolver::solve(const FullMu &mu, Relaxed relaxed) {
  return solve_from(start(mu), mu, relaxed.beta);
}

std::optional<ReducedAnswer> FollowingSolver::near(const ReducedAnswer &from, const FullMu &mu) {
  if (from.motions) return {};
  ReducedAnswer answer = solve_from({from.contact.state.displacement, from.start}, mu, {});
  answer.passes_kink = differs_in_contact(from.lambda, answer.lambda);
  return answer;
}

ReducedAnswer FollowingSolver::solve_from(const Start &start, const FullMu &mu,
                                          const Vector &beta) {
  if (evaluated_.set_compliance(mu) && nodal_) nodal_->forget();
  at_mu_.set(mu, beta);
  Vector load, unloaded; // half response to it, the displacement without contact
  Compliance &compliance = evaluated_.compliance();
  NonlinearContact problem{.compliance = &compliance,
                           .free = Vector::Zero(compliance.size()),
                           .undeformed = undeformed(contact_, scene_, mu),
                           .laws = laws_at(columns_, contact_, mu),
                           .w_product = w_product_};
  if (at_mu_.has_load()) {
    load = at_mu_.half_response_to_load();
    unloaded = at_mu_.transposed_half_response(load);
    problem.free = model_.contact.trace * unloaded;
  }
  NonlinearOptions options = steps_;
  if (!nodal_ && has_curvature(contact_) && !problem.laws.has_tangents() &&
      options.method == NonlinearMethod::automatic)
    options.tolerance = 1e-8; // the change after it is of second order
  FollowedContact followed{
      .contact = contact_, .mu = mu, .rows = rows_are_identity_ ? nullptr : &evaluated_.rows()};
  NonlinearResult found =
      solve_following(followed, nodal_ ? &*nodal_ : nullptr, problem, start, options);
  check_residual(found.residual, query_residual_limit,
                 ": reduce again with more training parameters");
  ReducedAnswer answer;
  answer.mu = mu;
  if (looks_for_others_) answer.to_other = distance_from_rest(problem, found, options);
  answer.contact = std::move(followed.operators);
  const bool held_by_contact = model_.body.springs.size() > 0; // then B is asked for at the answer
  if (held_by_contact)
    assemble(contact_, mu, {found.state}, answer.contact);
  else
    assemble_nodal(contact_, mu, {found.state}, followed.at_dual_dofs(found.x), answer.contact);
  answer.reaction = std::move(found.reaction);
  answer.energy = 0.5 * (answer.reaction.dot(problem.free - found.state) - load.squaredNorm());
  answer.u = evaluated_.moved_by(at_mu_, answer.reaction);
  if (unloaded.size() > 0) answer.u += unloaded;
  answer.beyond_basis = found.state - model_.contact.trace * answer.u;
  if (held_by_contact) {
    const Matrix motions = at_mu_.free_motions();
    const Matrix held =
        evaluated_.rows() * (answer.contact.b * Matrix(model_.contact.trace * motions));
    answer.motions = free_motions_at(at_mu_, motions, held, problem.laws);
  }
  answer.residual = found.residual;
  answer.iterations = found.steps;
  answer.load_steps = found.load_steps;
  answer.contraction = found.rate;
  answer.lambda = std::move(found.x);
  answer.start = std::move(found.start);
  starts_.keep({std::move(found.state), answer.start});
  return answer;
}

} // namespace rbvi
