#include "rbvi/contact/following.hpp"
#include "rbvi/solve/methods.hpp"

namespace rbvi {

FollowingResult solve_following(FactoredBody &body, const Problem &problem, Operators &op,
                                const Vector &slip, const Start &start,
                                const NonlinearOptions &options) {
  const Contact &contact = problem.contact();
  NonlinearContact nonlinear{.compliance = &body,
                             .free = body.free(op),
                             .undeformed = undeformed(contact, problem.scene(), op.mu),
                             .laws = op.laws,
                             .w_product = problem.w_product()};
  FollowedContact followed{.contact = contact, .mu = op.mu, .slip = slip, .weights = op.weights};
  const ContactInterface *nodal = nodal_interface(contact);
  if (nodal != nullptr && !body.nodal) body.nodal.emplace(nodal->averages());
  FollowingResult found;
  auto &[result, steps] = found;
  steps = solve_following(followed, nodal != nullptr ? &*body.nodal : nullptr, nonlinear, start,
                          options);
  assemble(contact, op.mu, {steps.state, slip}, op);
  RBVI_CALL(VecDuplicate(op.f, result.free_u.put()));
  result.lambda = steps.x;
  result.start = steps.start;
  result.active = steps.active;
  result.iterations = steps.steps;
  result.columns = static_cast<int>(body.count());
  result.converged = true;
  result.reason = steps.reason;
  result.u_error = body.displacement(op, result.lambda, result.free_u.get());
  return found;
}

} // namespace rbvi
