#include "rbvi/solve/high_fidelity.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/local_fit.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/imposed.hpp"
#include "rbvi/solve/methods.hpp"
#include "vectors.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

double ratio(double value, double scale) {
  return scale > 0 ? value / scale : value;
}

/// At all dofs in natural order, the imposed values among them. Collective.
Vector whole_displacement(const Problem &problem, const Mu &mu, Vec u) {
  Vector whole = to_natural(problem.dofs(), u);
  if (imposes_values(problem.scene())) whole += problem.imposed_displacement(mu);
  return whole;
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
  outputs.energy = images * (quadratic / 2 - linear + op.imposed_energy);
  outputs.kkt_residual = solution.kkt.largest();
  const Vector excess = op.nodal_b * restrict_to(problem.trace(), result.u.get()) - op.nodal_gap;
  outputs.max_penetration = excess.size() > 0 ? std::max(0.0, excess.maxCoeff()) : 0;
  outputs.iterations = result.iterations;
  contact_outputs(problem.contact(), op.mu, op, result.lambda, 0, outputs);
  if (problem.scene().components == 1) outputs.min_u = solution.u.minCoeff();
  return outputs;
}

/// Where a few dozen accelerated Uzawa steps see contact: far cheaper than the columns of all
/// nodes.
Start rough_start(KSP ksp, const Problem &problem, const Operators &op) {
  HfOptions rough;
  rough.uzawa_accelerated = true;
  rough.uzawa_tolerance = 1e-3;
  rough.uzawa_max_iterations = 100;
  MethodResult found = solve_uzawa(ksp, problem.trace(), op, problem.w_product(), rough);
  return {std::move(found.active), std::move(found.lambda)};
}

/// KktResidual::friction. `excess`: B u - G, in its tangential rows the slip; `scale`: |l| |G|.
double friction_residual(const Operators &op, const Vector &lambda, const Vector &excess,
                         double scale) {
  const NodeLaws &laws = op.laws;
  const Vector bounds = bounds_of(laws, lambda);
  double above = 0, idle = 0;
  for (Index i = 0; i < laws.nodes(); ++i) {
    if (!laws.has_tangent(i)) continue;
    const Index row = laws.tangent[static_cast<std::size_t>(i)];
    const auto stress = lambda.segment(row, laws.tangents);
    const auto slip = excess.segment(row, laws.tangents);
    above = std::max(above, stress.norm() - bounds[i]);
    idle += std::abs(bounds[i] * slip.norm() - stress.dot(slip));
  }
  return std::max(ratio(above, lambda.cwiseAbs().maxCoeff()), ratio(idle, scale));
}

} // namespace

const std::vector<std::string> &hf_method_names() {
  static const std::vector<std::string> names{"active_set", "uzawa", "vi"};
  return names;
}

double KktResidual::largest() const {
  return std::max({stationarity, feasibility, complementarity, sign, friction});
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
  for (Index i = 0; i < op.laws.nodes(); ++i) {
    if (!(op.weights[i] > 0)) continue;
    const Index row = op.laws.normal[static_cast<std::size_t>(i)];
    penetration = std::max(penetration, excess[row] / op.weights[i]);
    gap = std::max(gap, std::abs(op.g[row]) / op.weights[i]);
  }
  KktResidual kkt;
  kkt.stationarity = ratio(norm(r.get()), norm(op.f) + norm(reaction.get()));
  kkt.feasibility = ratio(penetration, gap);
  const Vector normal = lambda(op.laws.normal), left = excess(op.laws.normal);
  const double scale = lambda.norm() * op.g.norm();
  kkt.complementarity = ratio(normal.cwiseProduct(left).cwiseAbs().sum(), scale);
  kkt.sign = std::max(0.0, ratio(-normal.minCoeff(), normal.cwiseAbs().maxCoeff()));
  if (op.laws.has_tangents()) kkt.friction = friction_residual(op, lambda, excess, scale);
  return kkt;
}

HighFidelity::HighFidelity(Problem &problem, const HfOptions &options)
    : problem_(problem), options_(options), ksp_(make_direct_solver(problem.comm(), "hf_")) {
  if (options.method == HfMethod::vi) require_bounds_at_nodes(problem.scene());
  if (problem.nitsche()) {
    nitsche_ = std::make_unique<NitscheSolver>(problem, options.nitsche);
    return;
  }
  part_fits_ = options.method == HfMethod::active_set && ScaledPart::fits(problem.scene());
  if (constant_stiffness(problem.scene())) compliance_ = std::make_unique<Compliance>();
}

HighFidelity::~HighFidelity() = default;

const HighFidelity::Solved *HighFidelity::nearest(const Mu &mu) const {
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
  return nearest;
}

Start HighFidelity::nearest_start(const Mu &mu, const Operators &op) const {
  const bool columns_are_kept = part_ || (compliance_ && compliance_->count() > 0);
  if (solved_.empty()) return columns_are_kept ? Start{} : rough_start(ksp_.get(), problem_, op);
  return nearest(mu)->start;
}

Matrix HighFidelity::predicted_pressures(const Mu &mu) const {
  const ParameterSpace &space = problem_.scene().parameters;
  const auto count = static_cast<Index>(solved_.size());
  Matrix pressures(solved_.front().pressures.size(), count), points(space.size(), count);
  for (Index p = 0; p < count; ++p) {
    const Solved &solved = solved_[static_cast<std::size_t>(p)];
    pressures.col(p) = solved.pressures.reshaped();
    points.col(p) = parts_of_box(space, expand(space, solved.mu));
  }
  return local_fit(pressures, points, parts_of_box(space, expand(space, mu)))
      .reshaped(pressures.rows() / 2, 2);
}

HfSolution HighFidelity::solve_nitsche(const Mu &mu, const Operators &op) {
  NitscheStart start{};
  if (!solved_.empty()) start = {nearest(mu)->u.get(), predicted_pressures(mu)};
  NitscheSolution found = nitsche_->solve(op, solved_.empty() ? nullptr : &start);
  const Scene &scene = problem_.scene();
  const NitscheCurve &curve = *problem_.nitsche();
  const CurveFields fields = nitsche_fields(curve, op.mu, found.layer);
  HfSolution solution;
  solution.u = whole_displacement(problem_, mu, found.u.get());
  solution.lambda = nitsche_multiplier(fields, curve.friction());
  nitsche_outputs(nitsche_faces(curve, op.mu, curve.cells), found.pressures, fields,
                  nitsche_law(curve, op.mu), solution.outputs);
  solution.kkt.stationarity = found.residual;
  solution.outputs.energy = scene.mirror_images * (found.energy + op.imposed_energy);
  solution.outputs.kkt_residual = found.residual;
  solution.outputs.iterations = solution.iterations = found.iterations;
  solution.reason = found.reason + ", " + std::to_string(found.iterations) + " Newton steps in " +
                    std::to_string(found.outer_iterations) + " loops, " +
                    std::to_string(found.factorisations) + " factorisations";
  solved_.push_back({mu, {}, std::move(found.u), std::move(found.pressures)});
  return solution;
}

MethodResult HighFidelity::run(const Mu &mu, const Operators &op) {
  const Trace &trace = problem_.trace();
  if (options_.method == HfMethod::uzawa)
    return solve_uzawa(ksp_.get(), trace, op, problem_.w_product(), options_);
  if (options_.method == HfMethod::vi) return solve_vi(problem_, op);
  if (part_) {
    part_->set(op);
    return solve_active_set(*part_, op, nearest_start(mu, op));
  }
  return solve_active_set(ksp_.get(), trace, op, nearest_start(mu, op), compliance_.get());
}

HfSolution HighFidelity::solve(const Mu &mu) {
  const double start = MPI_Wtime();
  if (part_fits_ && !part_ && solves_ > 0) part_ = std::make_unique<ScaledPart>(problem_);
  ++solves_;
  const Operators &op = problem_.assemble(mu);
  if (nitsche_) {
    HfSolution solution = solve_nitsche(mu, op);
    solution.outputs.seconds = MPI_Wtime() - start;
    return solution;
  }
  RBVI_CALL(KSPSetOperators(ksp_.get(), op.a, op.a));
  const MethodResult result = run(mu, op);
  if (!result.converged)
    throw failure(result.reason + " (" + std::to_string(result.iterations) + " iterations)");

  HfSolution solution;
  solution.u = whole_displacement(problem_, mu, result.u.get());
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
  solved_.push_back(
      {mu, {solution.active, result.start.size() > 0 ? result.start : solution.lambda}, {}, {}});
  return solution;
}

} // namespace rbvi
