#include "rbvi/rom/support/support_solver.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/local_fit.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/rom/model/affine_coefficients.hpp"

#include <cmath>
#include <limits>

namespace rbvi {

namespace {

constexpr double largest_residual = 1e-8;
constexpr double mended_above = 1e-6; ///< natural residual of a reduced law at all nodes

} // namespace

SupportSolver::SupportSolver(const ReducedModel &model, const Scene &scene, const Contact &contact)
    : model_(model), scene_(scene), contact_(contact), stiffness_(model, scene) {
  if (!model.support) throw bad_input("the model has no law of contact at nodes");
  if (model.support->reduction != MultiplierReduction::condensed) law_.emplace(*model.support);
  samples_ = parts_of_box(scene.parameters, model.support->starts_mu);
}

/// The free parameters as parts of the box.
Vector SupportSolver::start_at(const Vector &here) const {
  constexpr double far_nearer = 0.1;
  const double next = samples_.cols() > 0 ? (samples_.colwise() - here).colwise().norm().minCoeff()
                                          : std::numeric_limits<double>::infinity();
  if (last_start_.size() > 0 && (last_ - here).norm() <= far_nearer * next) return last_start_;
  if (samples_.cols() == 0) return {};
  return local_fit(model_.support->starts, samples_, here);
}

Vector SupportSolver::term_coefficients(const FullMu &all_parameters, const Vector &theta_b) const {
  const CondensedOperator &condensed = model_.support->condensed;
  const Vector shape = condensed.shape * grid_weights(scene_, condensed.axes, all_parameters);
  Vector result(condensed.terms.cols());
  Index at = 0;
  for (Index p = 0; p < theta_b.size(); ++p)
    for (Index q = p; q < theta_b.size(); ++q, at += shape.size())
      result.segment(at, shape.size()) = theta_b[p] * theta_b[q] * shape;
  return result;
}

BodyAtMu SupportSolver::body_at(const FullMu &all_parameters, const Vector &theta_b) {
  const SupportModel &support = *model_.support;
  BodyAtMu body;
  if (support.condensed.terms.size() > 0) body.terms = term_coefficients(all_parameters, theta_b);
  if (support.reduction == MultiplierReduction::collocated)
    body.b = (model_.b.reduced * theta_b).reshaped(model_.generators, model_.primal_size());
  stiffness_.set(all_parameters);
  if (model_.online_enriched)
    stiffness_.restrict_to(enriched_subspace(
        multiplier_coefficients(support.basis).transpose() * body.b, model_.modes));
  body.stiffness = &stiffness_;
  body.q =
      model_.g.reduced * contact_coefficients(model_.g, Part::g, contact_, scene_, all_parameters);
  if (model_.f.size() > 0) {
    body.load = stiffness_.half_response(
        model_.f.reduced * affine_coefficients(model_.f, scene_.f, scene_, all_parameters));
    body.q -= stiffness_.half_response(body.b.transpose()).transpose() * body.load;
  }
  body.bound = contact_.interfaces.front()->bound(all_parameters);
  return body;
}

SupportSolver::AtAllNodes SupportSolver::at_all_nodes(const BodyAtMu &body, const Vector &x) const {
  const Index m = model_.generators;
  const Matrix h = (model_.support->condensed.terms * body.terms).reshaped(m, m);
  AtAllNodes result{h * x + body.q, h.diagonal(), {}};
  result.start = x - result.w.cwiseQuotient(result.diagonal);
  return result;
}

Vector SupportSolver::start_of(const FullMu &all_parameters, const Vector &x) {
  const BodyAtMu body = body_at(
      all_parameters, contact_coefficients(model_.b, Part::b, contact_, scene_, all_parameters));
  return at_all_nodes(body, x).start;
}

bool SupportSolver::solve_reduced_law(const BodyAtMu &body, SupportAnswer &answer) {
  const bool checks = model_.support->condensed.terms.size() > 0;
  const bool mends = model_.support->mended && checks;
  try {
    ReducedLawAnswer reduced = law_->solve(body);
    answer.x = std::move(reduced.x);
    answer.residual = reduced.residual;
    answer.iterations = reduced.iterations;
  } catch (const Error &) {
    if (!mends) throw;
    return false;
  }
  if (!checks) return true;
  AtAllNodes nodes = at_all_nodes(body, answer.x);
  answer.energy = 0.5 * answer.x.dot(nodes.w - body.q);
  answer.residual =
      natural_residual(answer.x, nodes.w, nodes.diagonal, model_.support->normal, body.bound);
  answer.start = std::move(nodes.start);
  return !mends || answer.residual <= mended_above;
}

void SupportSolver::solve_law(const BodyAtMu &body, const FullMu &all_parameters,
                              SupportAnswer &answer) {
  if (law_ && solve_reduced_law(body, answer)) return;
  const Index m = model_.generators;
  const Matrix &terms = model_.support->condensed.terms;
  const auto columns = [&](const std::vector<Index> &which) {
    Matrix result(m, static_cast<Index>(which.size()));
    for (std::size_t k = 0; k < which.size(); ++k)
      result.col(static_cast<Index>(k)).noalias() = terms.middleRows(which[k] * m, m) * body.terms;
    return result;
  };
  const Vector start = answer.start.size() > 0
                           ? answer.start
                           : start_at(parts_of_box(scene_.parameters, all_parameters));
  FrictionResult found = solve_friction(
      columns, body.q, static_cast<int>(m) / model_.support->normal, body.bound, start);
  if (!found.converged || !(found.residual <= largest_residual))
    throw failure("the law of contact and friction is met to " + short_number(found.residual) +
                  " only: " + found.reason);
  answer.energy = 0.5 * found.x.dot(found.w - body.q);
  answer.residual = found.residual;
  answer.iterations += found.iterations;
  answer.x = std::move(found.x);
  answer.start = std::move(found.start);
}

SupportAnswer SupportSolver::solve(const FullMu &all_parameters) {
  SupportAnswer answer;
  answer.theta_b = contact_coefficients(model_.b, Part::b, contact_, scene_, all_parameters);
  const BodyAtMu body = body_at(all_parameters, answer.theta_b);
  solve_law(body, all_parameters, answer);
  answer.u = -stiffness_.response(answer.theta_b, answer.x);
  if (body.load.size() > 0) answer.u += stiffness_.transposed_half_response(body.load);
  if (model_.support->condensed.terms.size() == 0)
    answer.energy = 0.5 * (stiffness_.half_response(body.b.transpose() * answer.x).squaredNorm() -
                           body.load.squaredNorm());
  last_start_ = answer.start;
  last_ = parts_of_box(scene_.parameters, all_parameters);
  return answer;
}

} // namespace rbvi
