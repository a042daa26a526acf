#include "rbvi/method/lcp.hpp"
#include "rbvi/method/several_answers.hpp"
#include "rbvi/solve/methods.hpp"
#include "rbvi/solve/vectors.hpp"

#include <algorithm>

namespace rbvi {

namespace {

template <class Found> void take(Found &&found, MethodResult &result) {
  result.lambda = std::move(found.x);
  result.w = std::move(found.w);
  result.active = std::move(found.active);
  result.iterations = found.iterations;
  result.columns = found.columns;
  result.converged = found.converged;
  result.reason = std::move(found.reason);
}

/// MethodResult::moved. `q`: g - B u_0.
double moved_by_parts(const Operators &op, const Vector &q, const Vector &w) {
  const Vector parts = (op.g - q).cwiseAbs() + (w - q).cwiseAbs();
  double largest = 0;
  for (Index node = 0; node < op.laws.nodes(); ++node)
    if (op.weights[node] > 0)
      largest = std::max(largest, parts[op.laws.normal[node]] / op.weights[node]);
  return largest;
}

/// u of A u = F - B^T lambda by that of an earlier lambda: where u is large beside its round-off, B
/// u stays as exact as the change is small.
void move_by_change(FullBody &body, const Operators &op, const MethodResult &before,
                    MethodResult &result) {
  const Handle<Vec> no_load = like(op.f);
  RBVI_CALL(VecZeroEntries(no_load.get()));
  Operators without_load = op;
  without_load.f = no_load.get();
  body.displacement(without_load, result.lambda - before.lambda, result.free_u.get());
  RBVI_CALL(VecAXPY(result.free_u.get(), 1, before.free_u.get()));
  result.u_error = before.u_error;
}

} // namespace

MethodResult solve_active_set(FullBody &body, const Operators &op, const Vector &start,
                              const ActiveSetOptions &options) {
  const ColumnSource columns = [&](const std::vector<Index> &which) {
    return condensed_columns(body, op.b, which);
  };
  Vector q = op.g - op.b * body.free(op);
  if (options.correction.size() > 0) q += options.correction;
  MethodResult result;
  RBVI_CALL(VecDuplicate(op.f, result.free_u.put()));
  if (!op.laws.has_tangents()) {
    take(
        solve_lcp(columns, q, start.size() > 0 ? in_contact(op.laws, start) : std::vector<Index>()),
        result);
  } else {
    FrictionSolver friction(columns, op.laws);
    FrictionAnswer found = friction.answer(q, start, options.by_rule);
    result.to_other = options.held.size() > 0
                          ? distance_seen_from(columns, q, op.laws, found, options.held)
                          : distance_seen(friction, found, options.looks_for_others);
    result.start = std::move(found.start);
    take(std::move(found), result);
  }
  if (result.lambda.size() == 0) return result; // not converged: there is no displacement either
  result.moved = moved_by_parts(op, q, result.w);
  if (options.refined != nullptr)
    move_by_change(body, op, *options.refined, result);
  else
    result.u_error = body.displacement(op, result.lambda, result.free_u.get());
  return result;
}

} // namespace rbvi
