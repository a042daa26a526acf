#include "rbvi/solve/high_fidelity.hpp"

#include "contact_method.hpp"
#include "rbvi/contact/force_balance.hpp"
#include "rbvi/contact/history.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/imposed.hpp"
#include "rbvi/fem/body_balance.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/vectors.hpp"

#include <array>
#include <cmath>

namespace rbvi {

namespace {

constexpr double least_told = 1e-8, least_known = 1e-3; ///< of u, relative
constexpr double balanced = 1e-10;                      ///< forces on a body, of their sizes
constexpr double of_stresses = 1e-3;                    ///< and of |diag(A) u|: round-off

/// |diag(A) u|.
double size_of_stresses(const Operators &op, Vec u) {
  const Handle<Vec> terms = like(u);
  RBVI_CALL(MatGetDiagonal(op.a, terms.get()));
  RBVI_CALL(VecPointwiseMult(terms.get(), terms.get(), u));
  return norm(terms.get());
}

} // namespace

void measure(const Problem &problem, const Operators &op, const Vector &weights,
             MethodResult &result) {
  const Handle<Vec> au = like(op.f);
  RBVI_CALL(MatMult(op.a, result.free_u.get(), au.get()));
  PetscScalar quadratic = 0, linear = 0;
  RBVI_CALL(VecDot(au.get(), result.free_u.get(), &quadratic));
  RBVI_CALL(VecDot(op.f, result.free_u.get(), &linear));

  Outputs &outputs = result.outputs;
  result.residual = result.kkt.largest();
  if (result.u_error > least_told)
    result.reason += ", round-off of the stiffness leaves " +
                     short_number(std::floor(-std::log10(result.u_error))) +
                     " digits of the displacement";
  outputs.energy = image_count(problem.scene().mirrors) *
                   (quadratic / 2 - linear + op.imposed_energy + problem.spring_energy());
  const Vector left = op.nodal_gap - op.nodal_b * restrict_to(problem.trace(), result.free_u.get());
  std::array<double, 2> penetration = penetration_at(left, op.nodal_gap);
  over_ranks(problem.comm(), MPI_MAX, penetration);
  set_penetration(penetration, outputs);
  ContactOperators of_outputs;
  of_outputs.weights = weights;
  of_outputs.state = op.state;
  contact_outputs(problem.contact(), op.mu, of_outputs, result.lambda, 0, outputs);
  if (!result.lambda.allFinite()) return; // which the residual says
  // Of several ranks each may have its own rows alone.
  check_forces(problem.scene(), problem.contact(), op.mu, op.state, result.lambda,
               ranks_of(problem.comm()) == 1 ? &op.b : nullptr);
}

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

void require_residual(const MethodResult &result, double allowed) {
  check_residual(result.residual, allowed,
                 ", and refinement leaves that: with an iterative -hf_ksp_type lower "
                 "-hf_ksp_rtol; else cells, or moduli, are too far apart in size");
  if (!(result.u_error <= least_known))
    throw failure("by round-off of the stiffness the displacement may be off by " +
                  short_number(result.u_error) +
                  " of itself: cells, or moduli, are too far apart in size");
}

Solved ContactMethod::kept(MethodResult &result) const {
  return {.start = {result.states.empty() ? Vector{} : result.states.back(),
                    result.start.size() > 0 ? result.start : result.lambda},
          .beta = result.beta};
}

HighFidelity::HighFidelity(Problem &problem, const HfOptions &options)
    : problem_(problem), options_(options), ksp_(make_direct_solver(problem.comm(), "hf_")),
      method_(make_contact_method(problem, options_, ksp_.get())),
      solved_(std::make_unique<Starts<Solved>>(problem.scene().parameters)) {}

HighFidelity::~HighFidelity() = default;

/// By the method of the options. Throws failure where it does not converge.
MethodResult HighFidelity::run(const Mu &mu, const Operators &op, const Vector &slip,
                               const Solved *near, bool continues) {
  MethodResult result = method_->solve({mu, op, slip, *solved_, near, continues});
  if (!result.converged) {
    const std::string shared = overdetermined(problem_.contact());
    throw failure(result.reason + " (" + std::to_string(result.iterations) + " iterations)" +
                  (shared.empty() ? "" : "; " + shared));
  }
  return result;
}

void HighFidelity::share_columns(const Groups &groups, const std::vector<Mu> &set) {
  method_->share_columns(groups, set);
}

void HighFidelity::forget() {
  solved_->clear();
}

HfSolution HighFidelity::solve(const Mu &mu, const Vector &slip) {
  check_history(problem_.contact(), slip);
  const double start = MPI_Wtime();
  const ContactRows rows = method_->begin(slip);
  const Operators &op = problem_.assemble(mu, rows, slip);
  method_->set(op);
  const Solved *near = solved_->nearest_added(op.mu);
  MethodResult result = problem_.free_bodies().empty() ? run(mu, op, slip, near, false)
                                                       : run_free(mu, op, slip, near);
  tell(result, result.outputs);
  result.u = whole_displacement(problem_, mu, result.free_u.get());
  add_named_outputs(problem_, op.mu, result.u, result.lambda, result.outputs);
  if (problem_.scene().components == 1) result.outputs.min_u = result.u.minCoeff();
  if (result.outputs.gap_error && !follows_state(problem_.contact()))
    result.outputs.strained = strained_share(problem_, op.mu, result.u);
  result.outputs.seconds = MPI_Wtime() - start;
  check_finite(result.outputs);
  method_->check(result);
  const double tolerance = std::max(balanced, 10 * result.residual),
               round_off = balanced * of_stresses * size_of_stresses(op, result.free_u.get());
  check_balance(problem_, op.mu, result.outputs, tolerance, round_off);
  check_membrane(problem_, op.mu, result.u, result.lambda, result.outputs, tolerance, round_off);
  solved_->add(op.mu, method_->kept(result));
  return std::move(static_cast<HfSolution &>(result));
}

} // namespace rbvi
