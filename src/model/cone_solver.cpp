#include "rbvi/model/cone_solver.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/method/nonlinear.hpp"
#include "rbvi/method/residual.hpp"
#include "rbvi/model/affine_coefficients.hpp"
#include "rbvi/model/free_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace rbvi {

namespace {

constexpr double largest_pull = 1e-2;    ///< of the peak: negative pressure where contact is sure
constexpr double active_fraction = 1e-6; ///< of the peak: below it a node counts as free

/// Number of primal functions of one query.
Index solved_size(const ReducedModel &model) {
  if (!model.body.online_enriched) return model.primal_size();
  return model.body.modes + std::min(model.body.supremizers, model.contact.generators);
}

} // namespace

ConeSolver::ConeSolver(const ReducedModel &model, const Scene &scene, const Contact &contact,
                       const QueryOptions &options)
    : model_(model), scene_(scene), contact_(contact), options_(options), body_(model, scene),
      positive_(model.contact.free_modes == 0 && (model.contact.dual_basis.array() >= 0).all()),
      starts_(model.scene.parameters, model.made.trained_mu), at_mu_(body_),
      qp_(solved_size(model), model.contact.free_modes),
      g_(Vector::Zero(model.contact.generators)) {
  const Vector rows = model.contact.dual_basis.rowwise().lpNorm<Eigen::Infinity>();
  Index end = rows.size();
  while (end > 0 && rows[end - 1] == 0)
    --end;
  while (first_dual_ < end && rows[first_dual_] == 0)
    ++first_dual_;
  dual_rows_ = end - first_dual_;
}

void ConeSolver::evaluate(const Vector &state, ReducedAnswer &answer) {
  ContactOperators &op = answer.contact;
  assemble(contact_, answer.mu, {state}, op);
  const auto basis = model_.contact.dual_basis.middleRows(first_dual_, dual_rows_).transpose();
  g_.noalias() = basis * op.g.segment(first_dual_, dual_rows_);
  if (!model_.evaluates_contact()) return;
  const Matrix traces = op.b.middleRows(first_dual_, dual_rows_) * model_.contact.trace;
  b_.noalias() = basis * traces;
  turned_b_ = body_.turned(b_.transpose());
  root_of_y_ = 0;
}

/// Of the only term of B the sign alone is in b_.
void ConeSolver::set_b(const Vector &theta_b) {
  const bool scales = theta_b.size() == 1 && theta_b[0] != 0 && std::isfinite(theta_b[0]);
  b_scale_ = scales ? std::abs(theta_b[0]) : 1;
  const Vector theta = theta_b / b_scale_;
  if (theta.size() == theta_b_.size() && theta == theta_b_) return;
  b_ = (model_.contact.b.reduced * theta).reshaped(model_.contact.generators, model_.primal_size());
  theta_b_ = theta;
  turned_b_ = body_.turned(b_.transpose());
  root_of_y_ = 0;
}

void ConeSolver::set_y() {
  if (model_.body.online_enriched) at_mu_.restrict_to(enriched_subspace(b_, model_.body.modes));
  if (root_of_y_ == at_mu_.root_number()) return;
  y_ = at_mu_.scaled_half_response_of_turned(turned_b_);
  root_of_y_ = at_mu_.root_number();
  ++y_number_;
  qp_.reset();
}

void ConeSolver::solve_dual(ReducedAnswer &answer) {
  // The columns of Y are those of y_ times `scale`: x takes the factor instead.
  const double scale = b_scale_ / std::sqrt(at_mu_.scale());
  const NonnegativeQpReport report = qp_.solve(y_, at_mu_.half_response_to_load(), g_ / scale);
  if (report.unbounded)
    throw failure("the reduced constraints contradict each other: reduce again with more "
                  "supremizers (-pga_beta_fraction) or more modes (-pod_tolerance)");
  if (!report.converged)
    throw failure(
        "the reduced problem did not converge in " + std::to_string(report.iterations) +
        " active-set updates: reduce again with fewer functions of the pressure (-cone_tolerance)");
  answer.iterations = report.iterations;
  answer.lambda = qp_.x() / scale;
  answer.u = at_mu_.transposed_half_response(qp_.residual());
}

void ConeSolver::solve_pair(const Vector &state, ReducedAnswer &answer) {
  at_mu_.set(answer.mu, beta_);
  if (model_.evaluates_gap())
    evaluate(state, answer);
  else
    g_.noalias() = model_.contact.g.reduced *
                   contact_coefficients(model_.contact.g, Part::g, contact_, scene_, answer.mu);
  if (!model_.evaluates_contact())
    set_b(answer.theta_b =
              contact_coefficients(model_.contact.b, Part::b, contact_, scene_, answer.mu));
  set_y();
  f_ = at_mu_.load();
  solve_dual(answer);
}

void ConeSolver::finish(ReducedAnswer &answer) {
  const Vector au = at_mu_.times(answer.u), btx = b_scale_ * (b_.transpose() * answer.lambda),
               excess = b_scale_ * (b_ * answer.u) - g_;
  const Vector diagonal = at_mu_.diagonal();
  const Vector moved =
      answer.u.cwiseAbs() + (f_.cwiseAbs() + btx.cwiseAbs()).cwiseQuotient(diagonal.cwiseAbs());
  const double displacement = b_scale_ * (b_.cwiseAbs() * moved).maxCoeff();
  answer.energy = 0.5 * answer.u.dot(au) - f_.dot(answer.u);
  const NodeLaws laws = uniform_laws(b_.rows(), 1, {});
  const Vector weights = Vector::Ones(b_.rows());
  answer.residual = residual_of({laws, weights, g_, answer.lambda, excess, displacement, 0,
                                 model_.contact.free_modes},
                                {at_mu_.restricted(au + btx - f_).norm(),
                                 at_mu_.restricted(f_).norm() + at_mu_.restricted(btx).norm(),
                                 diagonal.cwiseProduct(answer.u).norm()})
                        .largest();
  answer.least_pressure = active_fraction;
  if (model_.body.springs.size() > 0) {
    const Matrix motions = at_mu_.free_motions();
    answer.motions = free_motions_at(at_mu_, motions, b_scale_ * (b_ * motions), laws);
  }
  check_residual(answer.residual, query_residual_limit,
                 ": reduce again with fewer functions of the pressure or more supremizers");
  if (!positive_) check_pull(answer);
}

void ConeSolver::check_pull(const ReducedAnswer &answer) const {
  const Vector pressure = model_.contact.dual_basis * answer.lambda;
  Index node = 0;
  if (pressure.minCoeff(&node) >= -largest_pull * pressure.maxCoeff()) return;
  const Point at = dual_points(contact_)[node];
  throw failure(
      (std::ostringstream(said_of(contact_, node) +
                              "the pressure is negative at the contact point of reference "
                              "coordinates ",
                          std::ios::ate)
       << at[0] << ' ' << at[1] << ' ' << at[2]
       << ": contact opens there, and never did in training; reduce again with more "
          "training parameters or a larger -cone_ring")
          .str());
}

/// From the undeformed body, on the trace of the primal basis, until (A.8) is met in its norm. A
/// state at which contact cannot be evaluated, as the bodies do not face each other there, is
/// halved towards the last one at which it can.
void ConeSolver::solve_following(ReducedAnswer &answer) {
  NonlinearOptions options{.method = NonlinearMethod::anderson, .tolerance = 1e-9, .load_steps = 0};
  if (options_.method == OnlineMethod::kacanov) options.method = NonlinearMethod::kacanov;
  int iterations = 0, solves = 0;
  Vector last_state;
  NonlinearContact contact;
  contact.advice = "reduce again with -multiplier_reduction condensed";
  contact.solve = [&](Vector &state) {
    for (;; state = (state + last_state) / 2) {
      try {
        solve_pair(state, answer);
        break;
      } catch (const Error &) {
        if (last_state.size() == 0 || ++solves == options.max_steps) throw;
      }
    }
    last_state = state;
    iterations += answer.iterations;
    return Iterate{.x = answer.lambda, .u = model_.contact.trace * answer.u};
  };
  const Vector rest = undeformed(contact_, scene_, answer.mu);
  const NonlinearResult found = solve_nonlinear(contact, {rest, {}}, options);
  if (!found.converged) throw failure(found.reason);
  answer.iterations = iterations;
  answer.contraction = found.rate;
  assemble(contact_, answer.mu, {found.state}, answer.contact);
}

void ConeSolver::solve_from_start(ReducedAnswer &answer) {
  if (follows_state(contact_))
    solve_following(answer);
  else
    solve_pair({}, answer);
  finish(answer);
}

std::vector<Index> ConeSolver::known_active(Index sample) const {
  std::vector<Index> active;
  const Matrix &starts = model_.contact.starts;
  for (Index j = 0; j < starts.rows() - model_.contact.free_modes; ++j)
    if (starts(j, sample) > 0) active.push_back(j);
  return active;
}

void ConeSolver::start(const FullMu &mu) {
  const bool y_stays = model_.body.a.size() == 1 && model_.contact.b.size() == 1;
  const ConeStart &start = starts_.nearest_from(mu, [&](Index sample) {
    const std::vector<Index> active = known_active(sample);
    if (!active.empty() && !y_stays) return ConeStart{active, {}, y_number_};
    const Vector there = model_.made.trained_mu.col(sample);
    ReducedAnswer unused;
    unused.mu = expand(scene_.parameters, {there.begin(), there.end()});
    qp_.start_from(active);
    solve_from_start(unused);
    ConeStart found{qp_.active(), {}, y_number_};
    if (y_stays) found.qp = qp_;
    return found;
  });
  if (start.qp && start.y_number == y_number_)
    qp_ = *start.qp;
  else
    qp_.start_from(start.active);
}

ReducedAnswer ConeSolver::solve(const FullMu &mu, Relaxed relaxed) {
  ReducedAnswer answer;
  answer.mu = mu;
  beta_ = std::move(relaxed.beta);
  if (!options_.warm) start(mu);
  solve_from_start(answer);
  return answer;
}

/// From the generators that act: where they stay, by one factorisation of theirs.
std::optional<ReducedAnswer> ConeSolver::near(const ReducedAnswer &from, const FullMu &mu) {
  if (from.motions || follows_state(contact_)) return {};
  ReducedAnswer answer;
  answer.mu = mu;
  const Index signs = from.lambda.size() - model_.contact.free_modes;
  std::vector<Index> active;
  for (Index j = 0; j < signs; ++j)
    if (from.lambda[j] > 0) active.push_back(j);
  qp_.start_from(std::move(active));
  solve_from_start(answer);
  answer.passes_kink = differs_in_contact(from.lambda.head(signs), answer.lambda.head(signs));
  return answer;
}

} // namespace rbvi
