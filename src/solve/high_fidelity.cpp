#include "rbvi/solve/high_fidelity.hpp"

#include "rbvi/contact/history.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/imposed.hpp"
#include "rbvi/method/several_answers.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/contact_cost.hpp"
#include "rbvi/solve/eliminated.hpp"
#include "rbvi/solve/methods.hpp"
#include "rbvi/solve/scaled_part.hpp"
#include "rbvi/solve/vectors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <tuple>

namespace rbvi {

namespace {

constexpr double largest_residual = 1e-10; ///< KKT, of an active-set method
constexpr double largest_of_uzawa = 1e-2;  ///< small steps alone do not tell of an answer
constexpr double refined_above = 1e-11;
constexpr int most_refinements = 2;

/// Sets the outputs, but for what the method itself knows. `weights`: of all normal multipliers.
void measure(const Problem &problem, const Operators &op, const Vector &weights,
             MethodResult &result) {
  const Handle<Vec> au = like(op.f);
  RBVI_CALL(MatMult(op.a, result.free_u.get(), au.get()));
  PetscScalar quadratic = 0, linear = 0;
  RBVI_CALL(VecDot(au.get(), result.free_u.get(), &quadratic));
  RBVI_CALL(VecDot(op.f, result.free_u.get(), &linear));

  const double images = problem.scene().mirror_images;
  Outputs &outputs = result.outputs;
  result.residual = result.kkt.largest();
  outputs.energy = images * (quadratic / 2 - linear + op.imposed_energy + problem.spring_energy());
  outputs.kkt_residual = result.residual;
  const Vector left = op.nodal_gap - op.nodal_b * restrict_to(problem.trace(), result.free_u.get());
  std::array<double, 2> penetration = penetration_at(left, op.nodal_gap);
  over_ranks(problem.comm(), MPI_MAX, penetration);
  set_penetration(penetration, outputs);
  outputs.iterations = result.iterations;
  ContactOperators of_outputs;
  of_outputs.weights = weights;
  of_outputs.state = op.state;
  contact_outputs(problem.contact(), op.mu, of_outputs, result.lambda, 0, outputs);
}

/// The history of friction that a solution leaves, all rows of B on this rank.
Vector slip_left(const Problem &problem, const Operators &op, const Vector &before,
                 const MethodResult &result) {
  if (tangential_size(problem.contact()) == 0) return {};
  return slip_of(problem.contact(), op.b * restrict_to(problem.trace(), result.free_u.get()) - op.g,
                 op.weights, before);
}

/// Where a few dozen accelerated Uzawa steps see contact: far cheaper than the columns of all
/// nodes.
Vector rough_start(KSP ksp, Problem &problem, const Operators &op) {
  const UzawaOptions rough{.tolerance = 1e-3, .max_iterations = 100, .accelerated = true};
  const DualLayout &layout = problem.dual_layout();
  const DistributedContact contact = distribute(layout, op, op.laws);
  const Handle<Mat> w = distribute(layout, problem.w_product());
  MethodResult found = solve_uzawa(ksp, layout, contact, op.f, w.get(), rough);
  return found.lambda.allFinite() ? found.lambda : Vector(); // not finite: B is zero
}

} // namespace

Vector whole_displacement(const Problem &problem, const Mu &mu, Vec u) {
  Vector whole = to_natural(problem.dofs(), u);
  if (imposes_values(problem.scene())) whole += problem.imposed_displacement(mu);
  return whole;
}

std::vector<Index> in_contact(const NodeLaws &laws, const Vector &lambda) {
  std::vector<Index> nodes;
  for (Index i = 0; i < laws.nodes(); ++i)
    if (lambda[laws.normal[i]] > 0) nodes.push_back(i);
  return nodes;
}

const std::vector<std::string> &hf_contact_names() {
  static const std::vector<std::string> names{"auto", "condensed", "eliminated"};
  return names;
}

const std::vector<std::string> &hf_method_names() {
  static const std::vector<std::string> names{"active_set", "uzawa", "vi"};
  return names;
}

HighFidelity::HighFidelity(Problem &problem, const HfOptions &options)
    : problem_(problem), options_(options), ksp_(make_direct_solver(problem.comm(), "hf_")) {
  if (options.method != HfMethod::active_set && follows_state(problem.contact()))
    throw bad_input("-hf_method " + hf_method_names()[static_cast<std::size_t>(options.method)] +
                    " is for small deformations: leave it out, or use -kinematics small");
  if (options.method == HfMethod::vi) require_bounds_at_nodes(problem.scene());
  if (!has_multipliers(problem.scene())) {
    if (const auto &free = problem.free_bodies(); !free.empty()) {
      const Index motions = motions_of(free);
      throw bad_input(describe(free, problem.scene().dim, Matrix::Identity(motions, motions)) +
                      ": impose displacements that prevent it, for by Nitsche's method contact "
                      "alone holds no body, or use -formulation mixed");
    }
    nitsche_ = std::make_unique<NitscheSolver>(problem, options.nitsche);
    return;
  }
  if (options.contact == HfContact::eliminated && follows_state(problem.contact()))
    throw bad_input("-hf_contact eliminated is for small deformations: leave it out, or use "
                    "-kinematics small");
  if (eliminates(problem, options)) grids_ = std::make_unique<GridSequence>(problem);
  const bool several_solves = follows_state(problem.contact()) || !problem.free_bodies().empty();
  const ColumnsLast last = constant_stiffness(problem.scene()) && !grids_ ? ColumnsLast::for_all_mu
                           : several_solves                               ? ColumnsLast::for_one_mu
                                                                          : ColumnsLast::for_one_b;
  body_ = std::make_unique<FactoredBody>(ksp_.get(), problem.trace(), last);
  part_fits_ =
      !grids_ && options.method == HfMethod::active_set && ScaledPart::fits(problem.scene());
}

HighFidelity::~HighFidelity() = default;

const HighFidelity::Solved *HighFidelity::nearest(const Mu &mu) const {
  if (last_) return &*last_;
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

Vector HighFidelity::nearest_start(const Mu &mu, const Operators &op) {
  const bool columns_are_kept = part_ || body_->count() > 0;
  if (const Solved *found = nearest(mu)) return found->start;
  return columns_are_kept ? Vector() : rough_start(ksp_.get(), problem_, op);
}

MethodResult HighFidelity::run_condensed(const Mu &mu, const Operators &op, const Vector &slip) {
  if (part_) part_->set(op);
  FullBody &body = part_ ? static_cast<FullBody &>(*part_) : *body_;
  ActiveSetOptions options{!last_, options_.looks_for_others, {}};
  MethodResult result = solve_active_set(body, op, nearest_start(mu, op), options);
  if (!result.converged) return result;
  const auto residual = [&] {
    return kkt_residual(problem_.trace(), op, result.free_u.get(), result.lambda);
  };
  result.kkt = residual();
  // H has the round-off of A^-1, which iterative refinement takes out.
  options = {false, false, Vector::Zero(op.g.size())};
  for (int pass = 0; pass < most_refinements && !(result.kkt.largest() <= refined_above); ++pass) {
    options.correction +=
        op.g - op.b * restrict_to(problem_.trace(), result.free_u.get()) - result.w;
    const Vector from = result.start.size() > 0 ? result.start : result.lambda;
    const auto [to_other, iterations, columns] =
        std::tuple{result.to_other, result.iterations, result.columns};
    result = solve_active_set(body, op, from, options);
    if (!result.converged) return result;
    result.to_other = std::max(to_other, result.to_other);
    result.iterations += iterations;
    result.columns += columns;
    result.kkt = residual();
  }
  measure(problem_, op, op.weights, result);
  result.slip = slip_left(problem_, op, slip, result);
  return result;
}

/// Without a result where elimination does not meet the laws, which then says why in `complaint`.
std::optional<MethodResult> HighFidelity::run_eliminated(const Mu &mu, const Operators &op,
                                                         const Vector &slip,
                                                         std::string &complaint) {
  try {
    const Solved *near = nearest(mu);
    const Vector start = near == nullptr ? Vector() : near->start;
    MethodResult result = grids_->solve(mu, op, start, 1e-13, !last_);
    if (!result.converged) {
      complaint = result.reason;
    } else {
      measure_over_ranks(op, distribute(problem_.dual_layout(), op, op.laws), slip, result);
      if (result.residual <= largest_residual) return result;
      complaint = "a KKT residual of " + short_number(result.residual) +
                  " is left: try -hf_contact condensed";
    }
  } catch (const Error &error) { // of every rank
    complaint = error.what();
  }
  if (options_.contact == HfContact::eliminated) throw failure(complaint);
  return std::nullopt;
}

MethodResult HighFidelity::run_eliminated_or_condensed(const Mu &mu, const Operators &op,
                                                       const Vector &slip) {
  std::string complaint;
  if (std::optional<MethodResult> result = run_eliminated(mu, op, slip, complaint))
    return std::move(*result);
  MethodResult result = run_condensed(mu, problem_.assemble(mu, ContactRows::all, slip), slip);
  result.reason += ", condensed because elimination failed: " + complaint;
  return result;
}

MethodResult HighFidelity::run_following(const Mu &mu, const Operators &at_rest,
                                         const Vector &slip) {
  NonlinearStart start{undeformed(problem_.contact(), problem_.scene(), at_rest.mu), {}};
  const Solved *near = nearest(mu);
  if (near != nullptr && !bounds_follow_pressure(at_rest.laws)) start = {near->state, near->start};
  Operators op = at_rest;
  auto [result, steps] = solve_following(*body_, problem_, op, slip, start, options_.nonlinear);
  result.kkt = kkt_residual(problem_.trace(), op, result.free_u.get(), result.lambda);
  measure(problem_, op, op.weights, result);
  result.load_steps = result.outputs.load_steps = steps.load_steps;
  result.slip = slip_left(problem_, op, slip, result);
  result.contraction = result.outputs.contraction = steps.rate;
  result.states = std::move(steps.iterates);
  result.states.push_back(std::move(steps.state));
  return std::move(result);
}

void HighFidelity::measure_over_ranks(const Operators &op, const DistributedContact &contact,
                                      const Vector &slip, MethodResult &result) {
  const DualLayout &layout = problem_.dual_layout();
  const Handle<Vec> lambda = distribute(layout, result.lambda);
  result.kkt = kkt_residual(contact, op, result.free_u.get(), lambda.get());
  const Vector weights = on_every_rank(layout, contact.weights.get())(op.laws.normal);
  measure(problem_, op, weights, result);
  if (tangential_size(problem_.contact()) == 0) return;
  const Handle<Vec> excess = like(contact.g.get());
  RBVI_CALL(MatMult(contact.b.get(), result.free_u.get(), excess.get()));
  RBVI_CALL(VecAXPY(excess.get(), -1, contact.g.get()));
  result.slip = slip_of(problem_.contact(), on_every_rank(layout, excess.get()), weights, slip);
}

MethodResult HighFidelity::run_over_ranks(const Operators &op, const Vector &slip) {
  const DualLayout &layout = problem_.dual_layout();
  const DistributedContact contact = distribute(layout, op, op.laws);
  if (!w_product_) w_product_ = distribute(layout, problem_.w_product());
  MethodResult result =
      options_.method == HfMethod::vi
          ? solve_vi(problem_, contact, op)
          : solve_uzawa(ksp_.get(), layout, contact, op.f, w_product_.get(), options_.uzawa);
  if (!result.converged) return result;
  result.active = in_contact(op.laws, result.lambda);
  measure_over_ranks(op, contact, slip, result);
  return result;
}

void HighFidelity::share_columns(const Groups &groups, const std::vector<Mu> &set) {
  if (!body_ || !body_->keeps_columns() || groups.count() == 1 ||
      std::ssize(set) < 2 * groups.count() || !problem_.scene().f.empty() ||
      options_.method != HfMethod::active_set)
    return;
  std::set<Index> dofs;
  Operators rows;
  Mat a = nullptr;
  for (const Mu &mu : set) {
    try {
      problem_.assemble_contact(mu, rows);
      if (a == nullptr) a = problem_.assemble(mu).a;
    } catch (const Error &) {
      continue; // of every group; the sample will say why
    }
    for (Index i = 0; i < rows.g.size(); ++i)
      for (SparseMatrix::InnerIterator entry(rows.b, i); entry && rows.g[i] < 0; ++entry)
        dofs.insert(entry.col());
  }
  if (a == nullptr) return;
  set_operator(ksp_.get(), a);
  body_->set(a);
  if (takes_complement(problem_, static_cast<double>(dofs.size()) / groups.count()))
    return body_->require_all(&groups);
  body_->require({dofs.begin(), dofs.end()}, groups);
}

void HighFidelity::complete_compliance() {
  const double half = problem_.trace().size / 2.0; // of the columns, as contact_cost has it
  if (body_->keeps_columns() && body_->count() == 0 && takes_complement(problem_, half))
    body_->require_all();
}

/// By the method of the options. Throws failure where it does not converge.
MethodResult HighFidelity::run(const Mu &mu, const Operators &op, const Vector &slip) {
  const bool by_sets = options_.method == HfMethod::active_set;
  MethodResult result = follows_state(problem_.contact()) ? run_following(mu, op, slip)
                        : grids_  ? run_eliminated_or_condensed(mu, op, slip)
                        : by_sets ? run_condensed(mu, op, slip)
                                  : run_over_ranks(op, slip);
  if (!result.converged)
    throw failure(result.reason + " (" + std::to_string(result.iterations) + " iterations)");
  return result;
}

HighFidelity::Solved HighFidelity::solved(const Mu &mu, const MethodResult &result) const {
  return {mu, result.start.size() > 0 ? result.start : result.lambda,  {},
          {}, result.states.empty() ? Vector{} : result.states.back(), result.beta};
}

HfSolution HighFidelity::solve(const Mu &mu, const Vector &slip) {
  check_history(problem_.contact(), slip);
  if (nitsche_ && slip.size() > 0)
    throw bad_input("a history of friction is for multipliers: use -formulation mixed");
  const double start = MPI_Wtime();
  if (part_fits_ && !part_ && solves_ > 0) part_ = std::make_unique<ScaledPart>(problem_);
  ++solves_;
  const bool by_sets = options_.method == HfMethod::active_set, condensed = by_sets && !grids_;
  const Operators &op =
      problem_.assemble(mu, condensed || nitsche_ ? ContactRows::all : ContactRows::own, slip);
  if (nitsche_) {
    HfSolution solution = solve_nitsche(mu, op);
    check_finite(solution.outputs);
    solution.outputs.seconds = MPI_Wtime() - start;
    return solution;
  }
  set_operator(ksp_.get(), op.a);
  const bool follows = follows_state(problem_.contact());
  if (body_) body_->set(op.a);
  if (condensed) complete_compliance();
  MethodResult result = problem_.free_bodies().empty() ? run(mu, op, slip) : run_free(mu, op, slip);
  result.u = whole_displacement(problem_, mu, result.free_u.get());
  add_named_outputs(problem_, op.mu, result.u, result.lambda, result.outputs);
  if (problem_.scene().components == 1) result.outputs.min_u = result.u.minCoeff();
  result.outputs.seconds = MPI_Wtime() - start;
  check_finite(result.outputs);
  const double allowed =
      follows ? std::max(largest_residual, 10 * options_.nonlinear.tolerance) : largest_residual;
  if (by_sets && !(result.residual <= allowed))
    throw failure("the KKT residual is " + short_number(result.residual) + ", above " +
                  short_number(allowed) +
                  ": is the mesh or the parameter extreme? Try "
                  "-hf_pc_factor_mat_solver_type mumps, or with an iterative -hf_ksp_type a "
                  "smaller -hf_ksp_rtol");
  if (options_.method == HfMethod::uzawa &&
      !(result.residual <= std::max(largest_of_uzawa, 10 * options_.uzawa.tolerance)))
    throw failure("Uzawa's steps are below -uzawa_tolerance, and a KKT residual of " +
                  short_number(result.residual) +
                  " is left: lower it, or try -uzawa_accelerated or -hf_method active_set");
  solved_.push_back(solved(mu, result));
  return std::move(static_cast<HfSolution &>(result));
}

} // namespace rbvi
