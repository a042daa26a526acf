#include "rbvi/rom/online.hpp"

#include "rbvi/contact/obstacle/contact_area.hpp"
#include "rbvi/contact/support/support_outputs.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/rom/model/affine_coefficients.hpp"
#include "rbvi/rom/model/packed.hpp"
#include "rbvi/rom/support/reduced_stiffness.hpp"

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

/// Number of primal functions of one query.
Index solved_size(const ReducedModel &model) {
  if (!model.online_enriched) return model.primal_size();
  return model.modes + std::min(model.supremizers, model.generators);
}

void check_kernel(const AffineTerms &terms, const Form &form, const std::string &name) {
  if (terms.size() > 0 && !form)
    throw bad_input("the model has terms of " + name + ", its scene in this build has not");
}

} // namespace

Vector normal_gap(const Scene &scene, const FullMu &all_parameters, const Matrix &contact_points,
                  const Vector &displacement) {
  Vector gap(contact_points.rows());
  for (Index i = 0; i < gap.size(); ++i) {
    const Point x = point_of(contact_points, i), n = scene.support->normal(all_parameters, x);
    const Point motion = scene.motion ? scene.motion(all_parameters, x) : Point{};
    gap[i] = scene.support->gap(all_parameters, x);
    for (int c = 0; c < scene.components; ++c) {
      const auto k = static_cast<std::size_t>(c);
      gap[i] -= n[k] * (motion[k] + displacement[i * scene.components + c]);
    }
  }
  return gap;
}

std::vector<Point> dual_points(const ReducedModel &model, const Scene &scene) {
  std::vector<Point> points;
  const Index count = model.two_bodies() ? model.slave_nodes : model.contact_points.rows();
  for (Index i = 0; i < count; ++i)
    points.push_back(point_of(model.contact_points, i));
  return model.two_bodies()
             ? multiplier_points(points, scene.pair->discretisation.multiplier, scene.degree)
             : points;
}

OnlineSolver::OnlineSolver(const ReducedModel &model) : OnlineSolver(model, scene_of(model)) {}

OnlineSolver::OnlineSolver(const ReducedModel &model, Scene scene)
    : model_(model), scene_(std::move(scene)), qp_(solved_size(model), model.free_modes) {
  check_terms_of(model.a, scene_.a, scene_.parameters, "a");
  check_terms_of(model.f, scene_.f, scene_.parameters, "f");
  if (scene_.nitsche || model.nitsche) {
    nitsche_ = std::make_unique<ReducedNitsche>(model, scene_);
    return;
  }
  if (scene_.support || model.support) {
    support_ = std::make_unique<SupportSolver>(model, scene_);
    return;
  }
  check_kernel(model.b, scene_.b, "b");
  check_kernel(model.g, scene_.g, "g");
  if (model.two_bodies() != scene_.pair.has_value() ||
      (scene_.pair && multiplier_count(model.slave_nodes, scene_.pair->discretisation.multiplier,
                                       scene_.degree) != model.dual_basis.rows()))
    throw bad_input("the contact curves of the model do not fit its scene in this build");
  for (Index i = 0; i < model.contact_points.rows() && model.two_bodies(); ++i)
    curves_.push_back(point_of(model.contact_points, i));
  const Vector rows = model.dual_basis.rowwise().lpNorm<Eigen::Infinity>();
  first_dual_ = 0;
  Index end = rows.size();
  while (end > 0 && rows[end - 1] == 0)
    --end;
  while (first_dual_ < end && rows[first_dual_] == 0)
    ++first_dual_;
  dual_rows_ = end - first_dual_;
  packed_.resize(model.a.reduced.rows());
  g_ = Vector::Zero(model.generators);
  positive_ = model.free_modes == 0 && (model.dual_basis.array() >= 0).all();
}

void OnlineSolver::enrich() {
  enrichment_ = enriched_subspace(b_, model_.modes);
  a_ = (enrichment_.transpose() * (a_.selfadjointView<Eigen::Lower>() * enrichment_)).eval();
  b_ = (b_ * enrichment_).eval();
}

void OnlineSolver::assemble_pair(const FullMu &all_parameters, ReducedSolution &solution) {
  solution.pair = couple_at(scene_, all_parameters, curves_, model_.slave_nodes);
  const auto basis = model_.dual_basis.middleRows(first_dual_, dual_rows_).transpose();
  const Matrix traces = solution.pair.b.middleRows(first_dual_, dual_rows_) * model_.contact_trace;
  b_.noalias() = basis * traces;
  g_.noalias() = basis * solution.pair.g.segment(first_dual_, dual_rows_);
}

void OnlineSolver::update_operators(const Vector &theta_a, const Vector &theta_b) {
  const bool anew = model_.online_enriched;
  const double a_ratio = anew ? 0 : ratio(theta_a, theta_a_);
  const double b_ratio = anew ? 0 : ratio(theta_b, theta_b_);
  const Index n = model_.primal_size();
  a_scale_ = a_ratio > 0 ? std::sqrt(a_ratio) : 1;
  b_scale_ = b_ratio > 0 ? b_ratio : 1;
  if (b_ratio == 0 && !model_.two_bodies()) {
    b_.resize(model_.generators, n);
    Eigen::Map<Vector>(b_.data(), b_.size()).noalias() = model_.b.reduced * theta_b;
    theta_b_ = theta_b;
  }
  if (a_ratio == 0) {
    theta_a_.resize(0);
    packed_.noalias() = model_.a.reduced * theta_a;
    a_.resize(n, n);
    unpack(packed_, a_);
    if (anew) enrich();
    l_ = a_;
    const Eigen::LLT<Eigen::Ref<Matrix>> factor(l_);
    if (factor.info() != Eigen::Success)
      throw failure("the reduced stiffness is not positive definite: reduce again with a smaller "
                    "-eim_tolerance, or stay closer to the training set");
    theta_a_ = theta_a;
  }
  if (a_ratio == 0 || b_ratio == 0) {
    y_ = b_.transpose();
    l_.triangularView<Eigen::Lower>().solveInPlace(y_);
    qp_.reset();
  }
}

void OnlineSolver::solve_dual(ReducedSolution &solution) {
  c_ = f_ / a_scale_;
  l_.triangularView<Eigen::Lower>().solveInPlace(c_);
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
  solution.x = qp_.x() / scale;
  solution.u = qp_.residual() / a_scale_;
  l_.transpose().triangularView<Eigen::Upper>().solveInPlace(solution.u);
}

double kkt_residual(const Vector &au, const Vector &btx, const Vector &f, const Vector &bu,
                    const Vector &g, const Vector &x, Index free) {
  const auto relative = [](double error, double scale) { return error == 0 ? 0 : error / scale; };
  const double stationarity = relative((au + btx - f).norm(), f.norm() + btx.norm());
  const double scale = std::max(g.lpNorm<Eigen::Infinity>(), bu.lpNorm<Eigen::Infinity>());
  const Vector excess = bu - g;
  const double unequal = free > 0 ? excess.tail(free).cwiseAbs().maxCoeff() : 0;
  const double infeasible = relative(std::max({0.0, excess.maxCoeff(), unequal}), scale);
  const double gap = relative(std::abs(x.dot(excess)), scale * x.lpNorm<1>());
  return std::max({stationarity, infeasible, gap});
}

void OnlineSolver::check(ReducedSolution &solution) {
  const Vector au = a_scale_ * a_scale_ * (a_.selfadjointView<Eigen::Lower>() * solution.u).eval();
  const Vector btx = b_scale_ * (b_.transpose() * solution.x);
  const Vector bu = b_scale_ * (b_ * solution.u);
  solution.energy = 0.5 * solution.u.dot(au) - f_.dot(solution.u);
  solution.kkt_residual = kkt_residual(au, btx, f_, bu, g_, solution.x, model_.free_modes);
  if (!(solution.kkt_residual <= largest_residual))
    throw failure((std::ostringstream("the reduced answer has a KKT residual of ", std::ios::ate)
                   << solution.kkt_residual
                   << ": reduce again with fewer generators or more supremizers")
                      .str());
  if (positive_) return;
  const Vector pressure = multiplier(solution);
  Index node = 0;
  if (pressure.minCoeff(&node) >= -largest_pull * pressure.maxCoeff()) return;
  const Point at = dual_points(model_, scene_)[static_cast<std::size_t>(node)];
  throw failure((std::ostringstream("the pressure is negative at the contact point of reference "
                                    "coordinates ",
                                    std::ios::ate)
                 << at[0] << ' ' << at[1] << ' ' << at[2]
                 << ": contact opens there, and never did in training; reduce again with more "
                    "training parameters or a larger -cone_ring")
                    .str());
}

ReducedSolution OnlineSolver::solve_at(const FullMu &all_parameters) {
  const auto theta = [&](const AffineTerms &terms, const auto &form) {
    return affine_coefficients(terms, form, scene_, all_parameters);
  };
  ReducedSolution solution;
  solution.mu = all_parameters;
  if (nitsche_) {
    NitscheAnswer answer = nitsche_->solve(all_parameters);
    solution.u = std::move(answer.u);
    solution.energy = answer.energy;
    solution.kkt_residual = answer.residual;
    solution.iterations = answer.iterations;
    return solution;
  }
  if (support_) {
    SupportAnswer answer = support_->solve(all_parameters);
    solution.u = std::move(answer.u);
    solution.x = std::move(answer.x);
    solution.theta_b = std::move(answer.theta_b);
    solution.energy = answer.energy;
    solution.kkt_residual = answer.residual;
    solution.iterations = answer.iterations;
    return solution;
  }
  if (model_.two_bodies())
    assemble_pair(all_parameters, solution);
  else
    solution.theta_b = theta(model_.b, scene_.b);
  update_operators(theta(model_.a, scene_.a), solution.theta_b);
  f_ = Vector::Zero(model_.primal_size());
  if (model_.f.size() > 0) f_.noalias() = model_.f.reduced * theta(model_.f, scene_.f);
  if (model_.online_enriched) f_ = (enrichment_.transpose() * f_).eval();
  if (model_.g.size() > 0) g_.noalias() = model_.g.reduced * theta(model_.g, scene_.g);
  solve_dual(solution);
  check(solution);
  if (model_.online_enriched) solution.u = (enrichment_ * solution.u).eval();
  return solution;
}

ReducedSolution OnlineSolver::solve(const Mu &mu, bool extrapolate) {
  check_query(scene_, mu, extrapolate);
  return while_doing("solving the reduced problem at " + describe(scene_.parameters, mu),
                     [&] { return solve_at(expand(scene_.parameters, mu)); });
}

Vector OnlineSolver::multiplier(const ReducedSolution &solution) const {
  if (nitsche_)
    return nitsche_multiplier(nitsche_->fields(solution.mu, solution.u),
                              scene_.support->friction.law != FrictionLaw::none);
  return model_.dual_basis * solution.x;
}

Vector OnlineSolver::contact_gap(const Mu &mu, const ReducedSolution &solution) const {
  const Vector trace = model_.contact_trace * solution.u;
  if (model_.two_bodies()) return solution.pair.nodal_gap - solution.pair.nodal_b * trace;
  const FullMu all = expand(scene_.parameters, mu);
  if (support_ || nitsche_) return normal_gap(scene_, all, model_.contact_points, trace);
  Vector gap = trace;
  for (Index i = 0; i < gap.size(); ++i)
    gap[i] -= scene_.obstacle(all, scene_.map(all, point_of(model_.contact_points, i)));
  return gap;
}

Vector OnlineSolver::field(const ReducedSolution &solution) const {
  if (model_.primal_basis.rows() == 0)
    throw failure("the model was read without its fields: no full field can be reconstructed");
  return model_.primal_basis * solution.u;
}

void OnlineSolver::support_outputs_of(const FullMu &all_parameters, const ReducedSolution &solution,
                                      Outputs &outputs) const {
  const Vector lambda = multiplier(solution), lift = model_.support->lift * solution.theta_b;
  const FrictionBound bound = friction_bound(scene_.support->friction, all_parameters);
  const MappedCurve curve = mapped_curve(model_, scene_, all_parameters);
  support_outputs({lambda, curve.weights, lift, bound, curve.points}, outputs);
}

Outputs OnlineSolver::outputs(const Mu &mu, const ReducedSolution &solution) const {
  Outputs result;
  const double images = scene_.mirror_images;
  result.energy = images * solution.energy;
  const Vector gap = contact_gap(mu, solution);
  result.max_penetration = gap.size() > 0 ? std::max(0.0, -gap.minCoeff()) : 0;
  result.kkt_residual = solution.kkt_residual;
  result.iterations = solution.iterations;
  const ValidationErrors &expected = expected_errors(model_);
  if (expected.count > 0 && in_box(scene_.parameters, mu)) {
    result.expected_error_u = expected.u_max;
    result.expected_error_lambda = std::max(expected.lambda_max, expected.tangential_max);
  }
  if (nitsche_) {
    nitsche_->outputs(solution.mu, solution.u, result);
    return result;
  }
  if (support_) {
    support_outputs_of(solution.mu, solution, result);
    return result;
  }
  const Vector lambda = multiplier(solution);
  const Vector weights = model_.two_bodies() ? solution.pair.weights
                                             : Vector(model_.lumped_weights * solution.theta_b);
  const double peak = lambda.maxCoeff();
  result.normal_force = images * weights.dot(lambda);
  result.peak_pressure = peak;
  const auto active = lambda.array() > active_fraction * std::max(0.0, peak);
  result.contact_measure =
      images * (scene_.lumped ? contact_area(weights, active.select(lambda, 0),
                                             model_.contact_cells, scene_.dim + 1)
                              : active.select(weights, 0).sum());
  result.contact_nodes = images * static_cast<double>(active.count());
  return result;
}

} // namespace rbvi
