#include "rbvi/rom/online.hpp"

#include "rbvi/core/error.hpp"

#include <cmath>
#include <sstream>

namespace rbvi {

namespace {

constexpr double largest_residual = 1e-8;
constexpr double active_fraction = 1e-6; ///< of the peak: below it a node counts as free

void unpack(const Vector &packed, Matrix &lower) {
  const Index n = lower.rows();
  for (Index j = 0, at = 0; j < n; at += n - j, ++j)
    lower.col(j).tail(n - j) = packed.segment(at, n - j);
}

/// theta / reference if both have one positive ratio, else 0: a term set of one scales.
double ratio(const Vector &theta, const Vector &reference) {
  if (theta.size() != 1 || reference.size() != 1) return 0;
  const double quotient = theta[0] / reference[0];
  return std::isfinite(quotient) && quotient > 0 ? quotient : 0;
}

void check_kernel(const AffineTerms &terms, const Form &form, const std::string &name) {
  if (terms.size() > 0 && !form)
    throw bad_input("the model has terms of " + name + ", its scene in this build has not");
}

} // namespace

OnlineSolver::OnlineSolver(const ReducedModel &model) : OnlineSolver(model, scene_of(model)) {}

OnlineSolver::OnlineSolver(const ReducedModel &model, Scene scene)
    : model_(model), scene_(std::move(scene)), qp_(model.primal_size()) {
  const Index n = model.primal_size(), r = model.generators;
  check_kernel(model.a, scene_.a, "a");
  check_kernel(model.b, scene_.b, "b");
  check_kernel(model.f, scene_.f, "f");
  check_kernel(model.g, scene_.g, "g");
  packed_.resize(n * (n + 1) / 2);
  a_.resize(n, n);
  l_.resize(n, n);
  b_.resize(r, n);
  y_.resize(n, r);
  f_ = Vector::Zero(n);
  g_ = Vector::Zero(r);
  c_.resize(n);
}

void OnlineSolver::update_operators(const Vector &theta_a, const Vector &theta_b) {
  const double a_ratio = ratio(theta_a, theta_a_), b_ratio = ratio(theta_b, theta_b_);
  a_scale_ = a_ratio > 0 ? std::sqrt(a_ratio) : 1;
  b_scale_ = b_ratio > 0 ? b_ratio : 1;
  if (a_ratio == 0) {
    packed_.noalias() = model_.a.reduced * theta_a;
    unpack(packed_, a_);
    l_.triangularView<Eigen::Lower>() = a_;
    theta_a_.resize(0);
    const Eigen::LLT<Eigen::Ref<Matrix>> factor(l_);
    if (factor.info() != Eigen::Success)
      throw failure("the reduced stiffness is not positive definite: reduce again with a smaller "
                    "-eim_tolerance, or stay closer to the training set");
    theta_a_ = theta_a;
  }
  if (b_ratio == 0) {
    Eigen::Map<Vector>(b_.data(), b_.size()).noalias() = model_.b.reduced * theta_b;
    theta_b_ = theta_b;
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
                    const Vector &g, const Vector &x) {
  const auto relative = [](double error, double scale) { return error == 0 ? 0 : error / scale; };
  const double stationarity = relative((au + btx - f).norm(), f.norm() + btx.norm());
  const double scale = std::max(g.lpNorm<Eigen::Infinity>(), bu.lpNorm<Eigen::Infinity>());
  const double infeasible = relative(std::max(0.0, (bu - g).maxCoeff()), scale);
  const double gap = relative(std::abs(x.dot(bu - g)), scale * x.sum());
  return std::max({stationarity, infeasible, gap});
}

void OnlineSolver::check(ReducedSolution &solution) {
  const Vector au = a_scale_ * a_scale_ * (a_.selfadjointView<Eigen::Lower>() * solution.u).eval();
  const Vector btx = b_scale_ * (b_.transpose() * solution.x);
  const Vector bu = b_scale_ * (b_ * solution.u);
  solution.energy = 0.5 * solution.u.dot(au) - f_.dot(solution.u);
  solution.kkt_residual = kkt_residual(au, btx, f_, bu, g_, solution.x);
  if (!(solution.kkt_residual <= largest_residual))
    throw failure((std::ostringstream("the reduced answer has a KKT residual of ", std::ios::ate)
                   << solution.kkt_residual
                   << ": reduce again with fewer generators or more supremizers")
                      .str());
}

ReducedSolution OnlineSolver::solve_at(const Mu &all_parameters) {
  const auto theta = [&](const AffineTerms &terms, const Form &form) {
    return affine_coefficients(terms, form, scene_, all_parameters);
  };
  ReducedSolution solution;
  solution.theta_b = theta(model_.b, scene_.b);
  update_operators(theta(model_.a, scene_.a), solution.theta_b);
  if (model_.f.size() > 0) f_.noalias() = model_.f.reduced * theta(model_.f, scene_.f);
  if (model_.g.size() > 0) g_.noalias() = model_.g.reduced * theta(model_.g, scene_.g);
  solve_dual(solution);
  check(solution);
  return solution;
}

ReducedSolution OnlineSolver::solve(const Mu &mu, bool extrapolate) {
  check_mu(scene_.parameters, mu, extrapolate);
  return while_doing("solving the reduced problem at " + describe(scene_.parameters, mu),
                     [&] { return solve_at(expand(scene_.parameters, mu)); });
}

Vector OnlineSolver::multiplier(const ReducedSolution &solution) const {
  return model_.dual_basis * solution.x;
}

Vector OnlineSolver::contact_gap(const Mu &mu, const ReducedSolution &solution) const {
  const Mu all = expand(scene_.parameters, mu);
  Vector gap = model_.contact_trace * solution.u;
  for (Index i = 0; i < gap.size(); ++i) {
    if (model_.primal_offset.size() > 0)
      gap[i] += model_.primal_offset[model_.contact_nodes[static_cast<std::size_t>(i)]];
    gap[i] -= scene_.obstacle(all, scene_.map(all, point_of(model_.contact_points, i)));
  }
  return gap;
}

Vector OnlineSolver::field(const ReducedSolution &solution) const {
  if (model_.primal_basis.rows() == 0)
    throw failure("the model was read without its fields: no full field can be reconstructed");
  Vector u = model_.primal_basis * solution.u;
  if (model_.primal_offset.size() > 0) u += model_.primal_offset;
  return u;
}

Outputs OnlineSolver::outputs(const Mu &mu, const ReducedSolution &solution) const {
  Outputs result;
  if (model_.primal_offset.size() == 0) result.energy = solution.energy;
  const Vector lambda = multiplier(solution);
  const Vector weights = model_.lumped_weights * solution.theta_b;
  const double peak = lambda.maxCoeff();
  result.normal_force = weights.dot(lambda);
  result.peak_pressure = peak;
  result.contact_measure =
      peak > 0 ? (lambda.array() > active_fraction * peak).select(weights, 0).sum() : 0;
  if (scene_.obstacle)
    result.max_penetration = std::max(0.0, -contact_gap(mu, solution).minCoeff());
  result.kkt_residual = solution.kkt_residual;
  result.iterations = solution.iterations;
  const ValidationErrors &expected = expected_errors(model_);
  if (expected.count > 0 && in_box(scene_.parameters, mu)) {
    result.expected_error_u = expected.u_max;
    result.expected_error_lambda = expected.lambda_max;
  }
  return result;
}

} // namespace rbvi
