#include "friction_normal.hpp"

#include "order.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi::friction {

namespace {

/// The largest violation, relative to the terms of its row, of the normal laws.
double normal_residual(const Vector &x, const Vector &w, const Vector &terms) {
  double worst = 0;
  for (Index i = 0; i < x.size(); ++i)
    if (x[i] > 0 || w[i] < 0) worst = std::max(worst, std::abs(w[i]) / terms[i]);
  return worst;
}

} // namespace

LcpResult normal_contact(LazyColumns &h, const Vector &q, Index nodes, const Vector &start,
                         const FrictionOptions &options) {
  const ColumnSource normals = [&](const std::vector<Index> &which) {
    h.require(which);
    Matrix result(nodes, static_cast<Index>(which.size()));
    for (std::size_t k = 0; k < which.size(); ++k)
      result.col(static_cast<Index>(k)) = h.column(which[k]).head(nodes);
    return result;
  };
  std::vector<Index> guess;
  for (Index i = 0; i < nodes && start.size() > 0; ++i)
    if (start[i] > 0) guess.push_back(i);
  return solve_lcp(normals, q.head(nodes), guess,
                   {.tolerance = options.tolerance, .max_iterations = options.max_iterations});
}

FrictionResult without_friction(LazyColumns &h, const Vector &q, const Laws &laws,
                                const Vector &start, const FrictionOptions &options) {
  const Index nodes = laws.nodes;
  LcpResult normal = normal_contact(h, q, nodes, start, options);
  FrictionResult result;
  result.iterations = normal.iterations;
  result.columns = normal.columns;
  result.backup_steps = normal.backup_steps;
  result.converged = normal.converged;
  result.reason = std::move(normal.reason);
  if (normal.x.size() != nodes) return result; // H is not positive definite
  Vector x = Vector::Zero(q.size());
  x.head(nodes) = normal.x;
  State point = evaluate(h, q, std::move(x));
  result.residual = normal_residual(normal.x, point.w, point.terms);
  result.start = smooth_start(h.diagonal(), laws, point);
  result.x = std::move(point.x);
  result.w = std::move(point.w);
  describe(result, laws, ActiveSets(nodes, laws.dim));
  return result;
}

} // namespace rbvi::friction
