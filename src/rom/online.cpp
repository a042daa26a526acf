#include "rbvi/rom/online.hpp"

#include "law/not_definite.hpp"

#include "rbvi/law/nonlinear/anderson.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/element/imposed.hpp"
#include "rbvi/rom/law/reduced_stiffness.hpp"
#include "rbvi/rom/model/affine_coefficients.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace rbvi {

namespace {

constexpr double largest_residual = 1e-8;
constexpr double largest_pull = 1e-2;    ///< of the peak: negative pressure where contact is sure
constexpr double active_fraction = 1e-6; ///< of the peak: below it a node counts as free

/// theta / reference if both have one positive ratio, else 0: a term set of one scales.
double ratio(const Vector &theta, const Vector &reference) {
  if (theta.size() != 1 || reference.size() != 1) return 0;
  const double quotient = theta[0] / reference[0];
  return std::isfinite(quotient) && quotient > 0 ? quotient : 0;
}

/// Throws bad_input where displacements are imposed by boundaries that the scene does not have.
void check_imposed_by(const ReducedModel &model, const Scene &scene) {
  std::vector<const std::vector<int> *> lists{&model.imposed_by};
  for (const InterfaceModel &interface : model.interfaces)
    lists.push_back(&interface.mesh.imposed_by);
  for (const AffineTerms *terms : {&model.f, &model.g, &model.imposed_energy})
    for (const SampleMesh &sample : terms->samples)
      lists.push_back(&sample.imposed_by);
  for (const std::vector<int> *list : lists)
    if (std::ranges::any_of(*list, [&](int b) { return b < -1 || b >= std::ssize(scene.fixed); }))
      throw bad_input("the imposed displacements of the model are not those of its scene in this "
                      "build");
}

/// Number of primal functions of one query.
Index solved_size(const ReducedModel &model) {
  if (!model.online_enriched) return model.primal_size();
  return model.modes + std::min(model.supremizers, model.generators);
}

} // namespace

OnlineSolver::OnlineSolver(const ReducedModel &model, const QueryOptions &options)
    : OnlineSolver(model, model.scene, options) {}

OnlineSolver::OnlineSolver(const ReducedModel &model, Scene scene, const QueryOptions &options)
    : model_(model), scene_(with_imposed_loads(std::move(scene))),
      imposed_energy_(rbvi::imposed_energy(scene_)), contact_(contact_of(model, scene_)),
      options_(options), qp_(solved_size(model), model.free_modes),
      starts_(model.scene.parameters, model.trained_mu) {
  check_terms_of(model.a, scene_.a, scene_.parameters, "a");
  check_terms_of(model.f, scene_.f, scene_.parameters, "f");
  check_imposed_by(model, scene_);
  check_terms_of(model.imposed_energy, imposed_energy_, scene_.parameters, "the imposed energy");
  if (contact_.dual_size() != model.dual_basis.rows() ||
      has_multipliers(scene_) != model.has_multipliers() ||
      (model.evaluates_contact() == separable_contact(scene_) && model.has_multipliers()))
    throw bad_input("the contact of the model does not fit its scene in this build");
  if (!model.has_multipliers()) {
    nitsche_ = std::make_unique<ReducedNitsche>(model, layer_of(contact_));
    return;
  }
  trace_.emplace(model, contact_);
  if (model.law) {
    law_ = std::make_unique<LawSolver>(model, scene_, contact_, options);
    nodal_basis_ = model.dual_basis.sparseView();
    return;
  }
  const Vector rows = model.dual_basis.rowwise().lpNorm<Eigen::Infinity>();
  first_dual_ = 0;
  Index end = rows.size();
  while (end > 0 && rows[end - 1] == 0)
    --end;
  while (first_dual_ < end && rows[first_dual_] == 0)
    ++first_dual_;
  dual_rows_ = end - first_dual_;
  if (model.a_change.rank() > 0) changed_.emplace(model);
  g_ = Vector::Zero(model.generators);
  positive_ = model.free_modes == 0 && (model.dual_basis.array() >= 0).all();
}

void OnlineSolver::enrich() {
  enrichment_ = enriched_subspace(b_, model_.modes);
  a_ = (enrichment_.transpose() * (a_.selfadjointView<Eigen::Lower>() * enrichment_)).eval();
  b_ = (b_ * enrichment_).eval();
}

void OnlineSolver::evaluate_contact(const Vector &state, ReducedAnswer &solution) {
  ContactOperators &op = solution.contact;
  assemble(contact_, solution.mu, {state}, op);
  const auto basis = model_.dual_basis.middleRows(first_dual_, dual_rows_).transpose();
  const Matrix traces = op.b.middleRows(first_dual_, dual_rows_) * model_.contact_trace;
  b_.noalias() = basis * traces;
  g_.noalias() = basis * op.g.segment(first_dual_, dual_rows_);
}

void OnlineSolver::update_changed(const Vector &theta_a, bool new_b) {
  a_scale_ = std::sqrt(changed_->set(theta_a));
  if (new_b) {
    fixed_y_ = b_.transpose();
    changed_->solve_fixed(fixed_y_);
  }
  if (!new_b && theta_a_ == theta_a) return;
  y_ = fixed_y_;
  changed_->solve_change(y_);
  ++y_number_;
  qp_.reset();
  theta_a_ = theta_a;
}

void OnlineSolver::update_operators(const Vector &theta_a, const Vector &theta_b) {
  const bool anew = model_.online_enriched;
  const double a_ratio = anew ? 0 : ratio(theta_a, theta_a_);
  const double b_ratio = anew ? 0 : ratio(theta_b, theta_b_);
  const Index n = model_.primal_size();
  a_scale_ = a_ratio > 0 ? std::sqrt(a_ratio) : 1;
  b_scale_ = b_ratio > 0 ? b_ratio : 1;
  if (b_ratio == 0 && !model_.evaluates_contact()) {
    b_.resize(model_.generators, n);
    Eigen::Map<Vector>(b_.data(), b_.size()).noalias() = model_.b.reduced * theta_b;
    theta_b_ = theta_b;
  }
  if (changed_) return update_changed(theta_a, b_ratio == 0);
  if (a_ratio == 0) {
    theta_a_.resize(0);
    stiffness_of(model_, theta_a, a_);
    if (anew) enrich();
    l_ = a_;
    if (!cholesky_in_place(l_)) throw stiffness_not_definite();
    theta_a_ = theta_a;
  }
  if (a_ratio == 0 || b_ratio == 0) {
    y_ = b_.transpose();
    solve_lower(l_, y_);
    ++y_number_;
    qp_.reset();
  }
}

void OnlineSolver::solve_dual(ReducedAnswer &solution) {
  c_ = f_ / a_scale_;
  if (changed_)
    changed_->solve_root(c_);
  else
    solve_lower(l_, c_);
  // The columns of the true Y are those kept, times `scale`: x takes the factor instead.
  const double scale = b_scale_ / a_scale_;
  const NonnegativeQpReport report = qp_.solve(y_, c_, g_ / scale);
  if (report.unbounded)
    throw failure("the reduced constraints contradict each other: reduce again with more "
                  "supremizers (-pga_beta_fraction) or more modes (-pod_tolerance)");
  if (!report.converged)
    throw failure("the reduced problem did not converge in " + std::to_string(report.iterations) +
                  " active-set updates: reduce again with fewer generators (-cone_tolerance)");
  solution.iterations = report.iterations;
  solution.lambda = qp_.x() / scale;
  solution.u = qp_.residual() / a_scale_;
  if (changed_)
    changed_->solve_transposed(solution.u);
  else
    solve_lower_transposed(l_, solution.u);
}

void OnlineSolver::finish(ReducedAnswer &solution) {
  const Vector au =
      changed_ ? changed_->times(solution.u)
               : a_scale_ * a_scale_ * (a_.selfadjointView<Eigen::Lower>() * solution.u).eval();
  const Vector btx = b_scale_ * (b_.transpose() * solution.lambda);
  const Vector bu = b_scale_ * (b_ * solution.u);
  solution.energy = 0.5 * solution.u.dot(au) - f_.dot(solution.u);
  const double terms = b_scale_ * (b_.cwiseAbs() * solution.u.cwiseAbs()).maxCoeff();
  solution.residual = kkt_residual(au, btx, f_, bu, g_, solution.lambda, model_.free_modes, terms);
  if (!(solution.residual <= largest_residual))
    throw failure((std::ostringstream("the reduced answer has a KKT residual of ", std::ios::ate)
                   << solution.residual
                   << ": reduce again with fewer generators or more supremizers")
                      .str());
  solution.u = in_primal_basis(solution.u);
  if (positive_) return;
  const Vector pressure = multiplier(solution);
  Index node = 0;
  if (pressure.minCoeff(&node) >= -largest_pull * pressure.maxCoeff()) return;
  const Point at = dual_points(contact_)[node];
  throw failure((std::ostringstream("the pressure is negative at the contact point of reference "
                                    "coordinates ",
                                    std::ios::ate)
                 << at[0] << ' ' << at[1] << ' ' << at[2]
                 << ": contact opens there, and never did in training; reduce again with more "
                    "training parameters or a larger -cone_ring")
                    .str());
}

void OnlineSolver::solve_pair(const Vector &state, ReducedAnswer &solution) {
  const auto theta = [&](const AffineTerms &terms, const auto &form) {
    return affine_coefficients(terms, form, scene_, solution.mu);
  };
  const auto of_contact = [&](const AffineTerms &terms, Part part) {
    return contact_coefficients(terms, part, contact_, scene_, solution.mu);
  };
  if (model_.evaluates_contact())
    evaluate_contact(state, solution);
  else
    solution.theta_b = of_contact(model_.b, Part::b);
  update_operators(theta(model_.a, scene_.a), solution.theta_b);
  f_ = Vector::Zero(model_.primal_size());
  if (model_.f.size() > 0) f_.noalias() = model_.f.reduced * theta(model_.f, scene_.f);
  if (model_.online_enriched) f_ = (enrichment_.transpose() * f_).eval();
  if (model_.g.size() > 0) g_.noalias() = model_.g.reduced * of_contact(model_.g, Part::g);
  solve_dual(solution);
}

Vector OnlineSolver::in_primal_basis(const Vector &u) const {
  return model_.online_enriched ? Vector(enrichment_ * u) : u;
}

/// From the undeformed body, on the trace of the primal basis, until (A.8) is met in its norm.
void OnlineSolver::solve_following(ReducedAnswer &solution) {
  constexpr int most_steps = 60;
  constexpr double tolerance = 1e-9;
  Vector state = undeformed(contact_, scene_, solution.mu), last_x;
  Anderson anderson(3);
  std::vector<Vector> images;
  int iterations = 0;
  double last_change = 0;
  for (int k = 0; k < most_steps; ++k) {
    solve_pair(state, solution);
    iterations += solution.iterations;
    images.push_back(model_.contact_trace * in_primal_basis(solution.u));
    const Vector change = images.back() - state;
    const bool settled = change.norm() <= tolerance * images.back().norm() && last_x.size() > 0 &&
                         (solution.lambda - last_x).norm() <= tolerance * solution.lambda.norm();
    if (settled) {
      solution.iterations = iterations;
      solution.contraction = last_change > 0 ? change.norm() / last_change : 0;
      assemble(contact_, solution.mu, {images.back()}, solution.contact);
      return;
    }
    last_x = solution.lambda;
    last_change = change.norm();
    const Vector shares = anderson.combine(change);
    if (std::ssize(images) > shares.size()) images.erase(images.begin());
    state.setZero();
    for (Index j = 0; j < shares.size(); ++j)
      state += shares[j] * images[j];
  }
  throw failure("the reduced condition that follows the displacement does not settle in " +
                std::to_string(most_steps) +
                " steps: reduce again with -multiplier_reduction condensed");
}

ReducedAnswer OnlineSolver::solve_at(const FullMu &all_parameters) {
  if (nitsche_) return nitsche_->solve(all_parameters);
  if (law_) return law_->solve(all_parameters);
  ReducedAnswer solution;
  solution.mu = all_parameters;
  if (!options_.warm) start_cone(all_parameters);
  solve_cone(solution);
  return solution;
}

void OnlineSolver::solve_cone(ReducedAnswer &solution) {
  if (follows_state(contact_))
    solve_following(solution);
  else
    solve_pair({}, solution);
  finish(solution);
}

void OnlineSolver::start_cone(const FullMu &all_parameters) {
  const Vector here = parts_of_box(model_.scene.parameters, all_parameters);
  const ConeStart &start = starts_.nearest(here, [&](Index sample) {
    const Vector mu = model_.trained_mu.col(sample);
    ReducedAnswer unused;
    unused.mu = expand(model_.scene.parameters, {mu.begin(), mu.end()});
    qp_.start_from({});
    solve_cone(unused);
    ConeStart found{qp_.active(), {}, y_number_};
    if (model_.a.size() == 1 && model_.b.size() == 1) found.qp = qp_; // Y stays
    return found;
  });
  if (start.qp && start.y_number == y_number_)
    qp_ = *start.qp;
  else
    qp_.start_from(start.active);
}

ReducedAnswer OnlineSolver::solve(const Mu &mu, bool extrapolate) {
  check_query(scene_, mu, extrapolate);
  return while_doing("solving the reduced problem at " + describe(scene_.parameters, mu), [&] {
    ReducedAnswer solution = solve_at(expand(scene_.parameters, mu));
    if (const AffineTerms &imposed = model_.imposed_energy; imposed.size() > 0)
      solution.energy += imposed.reduced.row(0).dot(
          affine_coefficients(imposed, imposed_energy_, scene_, solution.mu));
    return solution;
  });
}

Vector OnlineSolver::multiplier(const ReducedAnswer &solution) const {
  if (nitsche_) return nitsche_->multiplier(solution.mu, solution.u);
  return law_ ? Vector(nodal_basis_ * solution.lambda)
              : Vector(model_.dual_basis * solution.lambda);
}

ContactOperators OnlineSolver::nodal_operators(const ReducedAnswer &solution,
                                               const Vector &lambda) const {
  if (model_.evaluates_contact()) return solution.contact;
  ContactOperators operators;
  assemble_nodal(contact_, solution.mu, {}, lambda, operators);
  return operators;
}

Vector OnlineSolver::contact_gap(const ReducedAnswer &solution) const {
  const ContactOperators operators = nodal_operators(solution, multiplier(solution));
  return trace_->gap_left(operators, solution.u);
}

Vector OnlineSolver::field(const ReducedAnswer &solution) const {
  if (model_.primal_basis.rows() == 0)
    throw failure("the model was read without its fields: no full field can be reconstructed");
  Vector field = model_.primal_basis * solution.u;
  if (model_.imposed_by.empty()) return field;
  std::vector<Point> nodes;
  for (Index i = 0; i < model_.mesh_points.rows(); ++i)
    nodes.push_back(point_of(model_.mesh_points, i));
  return field + imposed_values(scene_, solution.mu, nodes, model_.imposed_by);
}

Outputs OnlineSolver::outputs(const Mu &mu, const ReducedAnswer &solution) const {
  Outputs result;
  const double images = scene_.mirror_images;
  result.energy = images * solution.energy;
  result.kkt_residual = solution.residual;
  result.iterations = solution.iterations;
  result.load_steps = solution.load_steps;
  result.contraction = solution.contraction;
  const ValidationErrors &expected = expected_errors(model_);
  if (expected.count > 0 && in_box(scene_.parameters, mu)) {
    result.expected_error_u = expected.u_max;
    result.expected_error_lambda = std::max(expected.lambda_max, expected.tangential_max);
  }
  if (nitsche_) {
    nitsche_->outputs(solution.mu, solution.u, result);
    check_finite(result);
    return result;
  }
  const Vector lambda = multiplier(solution);
  const ContactOperators operators = nodal_operators(solution, lambda);
  const Vector gap = trace_->gap_left(operators, solution.u);
  trace_->check_outside(operators, gap);
  result.max_penetration = gap.size() > 0 ? larger(0, -gap.minCoeff<Eigen::PropagateNaN>()) : 0;
  const double least = law_ ? 0 : active_fraction * std::max(0.0, lambda.maxCoeff());
  contact_outputs(contact_, solution.mu, operators, lambda, least, result);
  check_finite(result);
  return result;
}

} // namespace rbvi
