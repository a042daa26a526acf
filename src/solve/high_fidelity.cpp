#include "rbvi/solve/high_fidelity.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/solve/methods.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

double norm(Vec v) {
  PetscReal value = 0;
  RBVI_CALL(VecNorm(v, NORM_2, &value));
  return value;
}

double ratio(double value, double scale) {
  return scale > 0 ? value / scale : value;
}

Outputs measure(const Problem &problem, const Operators &op, const MethodResult &result,
                const HfSolution &solution) {
  Handle<Vec> au;
  RBVI_CALL(VecDuplicate(op.f, au.put()));
  RBVI_CALL(MatMult(op.a, result.u.get(), au.get()));
  PetscScalar quadratic = 0, linear = 0;
  RBVI_CALL(VecDot(au.get(), result.u.get(), &quadratic));
  RBVI_CALL(VecDot(op.f, result.u.get(), &linear));

  const double images = problem.scene().mirror_images;
  Outputs outputs;
  outputs.energy = images * (quadratic / 2 - linear);
  outputs.normal_force = images * op.weights.dot(result.lambda);
  double measure = 0;
  for (const Index i : result.active)
    measure += op.weights[i];
  outputs.contact_measure = images * measure;
  outputs.peak_pressure = result.lambda.maxCoeff();
  if (problem.scene().components == 1) outputs.min_u = solution.u.minCoeff();
  outputs.kkt_residual = solution.kkt.largest();
  const Vector excess = op.nodal_b * restrict_to(problem.trace(), result.u.get()) - op.nodal_gap;
  outputs.max_penetration = excess.size() > 0 ? std::max(0.0, excess.maxCoeff()) : 0;
  outputs.iterations = result.iterations;
  return outputs;
}

/// Where a few dozen accelerated Uzawa steps see contact: far cheaper than the columns of all
/// nodes.
std::vector<Index> rough_active_set(KSP ksp, const Problem &problem, const Operators &op) {
  HfOptions rough;
  rough.uzawa_accelerated = true;
  rough.uzawa_tolerance = 1e-3;
  rough.uzawa_max_iterations = 100;
  return solve_uzawa(ksp, problem.trace(), op, problem.w_product(), rough).active;
}

} // namespace

double KktResidual::largest() const {
  return std::max({stationarity, feasibility, complementarity, sign});
}

KktResidual kkt_residual(const Trace &trace, const Operators &op, Vec u, const Vector &lambda) {
  Handle<Vec> r, reaction;
  RBVI_CALL(VecDuplicate(op.f, r.put()));
  RBVI_CALL(VecDuplicate(op.f, reaction.put()));
  RBVI_CALL(VecZeroEntries(reaction.get()));
  const Vector bt_lambda = op.b.transpose() * lambda;
  add_extension(trace, bt_lambda, reaction.get());
  RBVI_CALL(MatMult(op.a, u, r.get()));
  RBVI_CALL(VecAXPY(r.get(), 1, reaction.get()));
  RBVI_CALL(VecAXPY(r.get(), -1, op.f));

  const Vector excess = op.b * restrict_to(trace, u) - op.g;
  double penetration = 0, gap = 0; // a multiplier without weight has no constraint
  for (Index i = 0; i < excess.size(); ++i) {
    if (!(op.weights[i] > 0)) continue;
    penetration = std::max(penetration, excess[i] / op.weights[i]);
    gap = std::max(gap, std::abs(op.g[i]) / op.weights[i]);
  }
  KktResidual kkt;
  kkt.stationarity = ratio(norm(r.get()), norm(op.f) + norm(reaction.get()));
  kkt.feasibility = ratio(penetration, gap);
  kkt.complementarity =
      ratio(lambda.cwiseProduct(excess).cwiseAbs().sum(), lambda.norm() * op.g.norm());
  kkt.sign = std::max(0.0, ratio(-lambda.minCoeff(), lambda.cwiseAbs().maxCoeff()));
  return kkt;
}

HighFidelity::HighFidelity(Problem &problem, const HfOptions &options)
    : problem_(problem), options_(options), ksp_(make_direct_solver(problem.comm(), "hf_")) {
  if (options.method == HfMethod::vi && problem.two_bodies())
    throw bad_input("vi needs a bound at each node, and two bodies bound differences of both: use "
                    "-hf_method active_set or uzawa");
  if (constant_stiffness(problem.scene())) compliance_ = std::make_unique<Compliance>();
}

HighFidelity::~HighFidelity() = default;

std::vector<Index> HighFidelity::nearest_active_set(const Mu &mu, const Operators &op) const {
  if (solved_.empty()) return rough_active_set(ksp_.get(), problem_, op);
  const ParameterSpace &space = problem_.scene().parameters;
  const Solved *nearest = nullptr;
  double best = 0;
  for (const Solved &solved : solved_) {
    double distance = 0;
    for (int i = 0; i < space.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      distance += std::pow((mu[k] - solved.mu[k]) / (space.at(i).upper - space.at(i).lower), 2);
    }
    if (nearest == nullptr || distance < best) {
      nearest = &solved;
      best = distance;
    }
  }
  return nearest->active;
}

MethodResult HighFidelity::run(const Mu &mu, const Operators &op) {
  const Trace &trace = problem_.trace();
  if (options_.method == HfMethod::uzawa)
    return solve_uzawa(ksp_.get(), trace, op, problem_.w_product(), options_);
  if (options_.method == HfMethod::vi) return solve_vi(problem_, op);
  return solve_active_set(ksp_.get(), trace, op, nearest_active_set(mu, op), compliance_.get());
}

HfSolution HighFidelity::solve(const Mu &mu) {
  const double start = MPI_Wtime();
  const Operators &op = problem_.assemble(mu);
  RBVI_CALL(KSPSetOperators(ksp_.get(), op.a, op.a));
  const MethodResult result = run(mu, op);
  if (!result.converged)
    throw failure(result.reason + " (" + std::to_string(result.iterations) + " iterations)");

  HfSolution solution;
  solution.u = to_natural(problem_.dofs(), result.u.get());
  solution.kkt = kkt_residual(problem_.trace(), op, result.u.get(), result.lambda);
  solution.outputs = measure(problem_, op, result, solution);
  solution.lambda = result.lambda;
  solution.active = result.active;
  solution.iterations = result.iterations;
  solution.columns = result.columns;
  solution.reason = result.reason;
  solution.outputs.seconds = MPI_Wtime() - start;
  if (options_.method == HfMethod::active_set && solution.kkt.largest() > 1e-10)
    throw failure("the KKT residual is " + short_number(solution.kkt.largest()) +
                  ", above 1e-10: is the mesh or the parameter extreme? Try "
                  "-hf_pc_factor_mat_solver_type mumps");
  solved_.push_back({mu, solution.active});
  return solution;
}

} // namespace rbvi
