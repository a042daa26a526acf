#include "rbvi/contact/history.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/solve/methods.hpp"

namespace rbvi {

MethodResult solve_following(FactoredBody &body, const Problem &problem, Operators &op,
                             const Vector &slip, const NonlinearStart &start,
                             const NonlinearOptions &options, NonlinearResult &steps) {
  const Contact &contact = problem.contact();
  ContactOperators at_state;
  NonlinearContact nonlinear{[&](const Vector &state, Linearised &linearised) {
                               assemble(contact, op.mu, {state, slip}, at_state);
                               linearised = {at_state.b, at_state.g, at_state.segments};
                             },
                             {},
                             body,
                             body.free(op),
                             undeformed(contact, problem.scene(), op.mu),
                             op.laws,
                             problem.w_product()};
  if (has_curvature(contact))
    nonlinear.curvature = [&](const Vector &state, const Vector &x) -> CurvatureRows {
      Curvature rows = curvature(contact, op.mu, {state}, x);
      return {std::move(rows.s), std::move(rows.e)};
    };
  if (const ContactInterface *nodal = nodal_interface(contact)) {
    if (!body.nodal) body.nodal.emplace(nodal->averages());
    nonlinear.nodal.emplace(
        NodalContact{nodal_with_history(contact, op.mu, slip, op.weights), *body.nodal});
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
  result.columns = static_cast<int>(body.count());
  result.converged = true;
  result.reason = steps.reason;
  body.displacement(op, result.lambda, result.free_u.get());
  return result;
}

} // namespace rbvi
