#include "friction_normal.hpp"

#include "friction_laws.hpp"

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

LcpResult normal_contact(LazyColumns &h, const Vector &q, const NodeLaws &laws, const Vector &start,
                         const FrictionOptions &options) {
  const ColumnSource normals = [&](std::vector<Index> which) {
    for (Index &node : which)
      node = laws.normal[node];
    h.require(which);
    Matrix result(laws.nodes(), std::ssize(which));
    for (Index k = 0; k < result.cols(); ++k) {
      const auto column = h.column(which[k]);
      for (Index i = 0; i < result.rows(); ++i) // twice as fast as an expression with indices
        result(i, k) = column[laws.normal[i]];
    }
    return result;
  };
  std::vector<Index> guess;
  for (Index i = 0; i < laws.nodes() && start.size() > 0; ++i)
    if (start[laws.normal[i]] > 0) guess.push_back(i);
  return solve_lcp(normals, q(laws.normal), guess,
                   {.tolerance = options.tolerance, .max_iterations = options.max_iterations});
}

FrictionResult without_friction(LazyColumns &h, const Vector &q, const NodeLaws &laws,
                                const Vector &start, const FrictionOptions &options) {
  LcpResult normal = normal_contact(h, q, laws, start, options);
  FrictionResult result;
  result.iterations = normal.iterations;
  result.columns = normal.columns;
  result.backup_steps = normal.backup_steps;
  result.converged = normal.converged;
  result.reason = std::move(normal.reason);
  if (normal.x.size() != laws.nodes()) return result; // H is not positive definite
  Vector x = Vector::Zero(q.size());
  x(laws.normal) = normal.x;
  State point = evaluate(h, q, std::move(x));
  result.residual = normal_residual(normal.x, point.w(laws.normal), point.terms(laws.normal));
  result.start = smooth_start(h.diagonal(), laws, point);
  result.x = std::move(point.x);
  result.w = std::move(point.w);
  describe(result, laws, ActiveSets(laws));
  return result;
}

} // namespace rbvi::friction
