#include "rbvi/contact/following.hpp"

#include "rbvi/contact/history.hpp"
#include "rbvi/core/error.hpp"

namespace rbvi {

NonlinearResult solve_following(FollowedContact &followed, NodalCompliance *nodal,
                                NonlinearContact &problem, const Start &start,
                                const NonlinearOptions &options) {
  const Contact &contact = followed.contact;
  ContactOperators &op = followed.operators;
  problem.linearise = [&](const Vector &state, Linearised &linearised) {
    assemble(contact, followed.mu, {state, followed.slip}, op);
    if (followed.rows == nullptr)
      linearised = {op.b, op.g, op.segments};
    else
      linearised = {*followed.rows * op.b, *followed.rows * op.g, op.segments};
  };
  if (has_curvature(contact))
    problem.curvature = [&](const Vector &state, const Vector &x) -> CurvatureRows {
      Curvature rows = curvature(contact, followed.mu, {state}, followed.at_dual_dofs(x));
      return {std::move(rows.s), std::move(rows.e)};
    };
  if (nodal != nullptr)
    problem.nodal.emplace(NodalContact{
        nodal_with_history(contact, followed.mu, followed.slip, followed.weights), *nodal});
  NonlinearResult result = solve_nonlinear(problem, start, options);
  if (!result.converged)
    throw failure(
        failure_at(contact, followed.mu, op, followed.at_dual_dofs(result.last_x), result.reason));
  return result;
}

} // namespace rbvi
