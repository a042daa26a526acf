#include "rbvi/contact/history.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/solve/methods.hpp"

namespace rbvi {

namespace {

/// The columns of A^-1 at the contact dofs, by solves over the ranks when they are required.
class SolvedColumns : public ComplianceColumns {
public:
  SolvedColumns(KSP ksp, const Trace &trace, Mat a, Compliance &kept)
      : ksp_(ksp), trace_(trace), a_(a), kept_(kept) {}
  Index size() const override { return trace_.size; }
  void require(const std::vector<Index> &dofs) override { kept_.require(ksp_, trace_, a_, dofs); }
  Eigen::Map<const Vector> column(Index dof) const override { return kept_.column(dof); }

private:
  KSP ksp_;
  const Trace &trace_;
  Mat a_;
  Compliance &kept_;
};

/// What the body does under its loads alone, at the contact dofs.
Vector free_displacement(KSP ksp, const Trace &trace, Vec f) {
  PetscReal load = 0;
  RBVI_CALL(VecNorm(f, NORM_INFINITY, &load));
  if (load == 0) return Vector::Zero(trace.size);
  Handle<Vec> u;
  RBVI_CALL(VecDuplicate(f, u.put()));
  solve_linear(ksp, f, u.get());
  return restrict_to(trace, u.get());
}

} // namespace

MethodResult solve_following(KSP ksp, const Problem &problem, Compliance &compliance, Operators &op,
                             const Vector &slip, const NonlinearStart &start,
                             const NonlinearOptions &options, NonlinearResult &steps) {
  const Contact &contact = problem.contact();
  SolvedColumns columns(ksp, problem.trace(), op.a, compliance);
  ContactOperators at_state;
  NonlinearContact nonlinear{[&](const Vector &state, Linearised &linearised) {
                               assemble(contact, op.mu, {state, slip}, at_state);
                               linearised = {at_state.b, at_state.g, at_state.segments};
                             },
                             {},
                             columns,
                             free_displacement(ksp, problem.trace(), op.f),
                             undeformed(contact, problem.scene(), op.mu),
                             op.laws,
                             problem.w_product()};
  if (has_curvature(contact))
    nonlinear.curvature = [&](const Vector &state, const Vector &x) -> CurvatureRows {
      Curvature rows = curvature(contact, op.mu, {state}, x);
      return {std::move(rows.s), std::move(rows.e)};
    };
  if (const ContactInterface *nodal = nodal_interface(contact)) {
    if (!compliance.nodal) compliance.nodal.emplace(nodal->averages());
    nonlinear.nodal.emplace(
        NodalContact{nodal_with_history(contact, op.mu, slip, op.weights), *compliance.nodal});
  }
  steps = solve_nonlinear(nonlinear, start, options);
  if (!steps.converged)
    throw failure(failure_at(contact, op.mu, at_state, steps.last_x, steps.reason));
  assemble(contact, op.mu, {steps.state, slip}, op);
  MethodResult result;
  RBVI_CALL(VecDuplicate(op.f, result.free_u.put()));
  result.lambda = steps.x;
  result.start = steps.start;
  result.active = steps.active;
  result.iterations = steps.steps;
  result.columns = static_cast<int>(compliance.count());
  result.converged = true;
  result.reason = steps.reason;
  solve_linear(ksp, reaction_rhs(problem.trace(), op, result.lambda).get(), result.free_u.get());
  return result;
}

} // namespace rbvi
