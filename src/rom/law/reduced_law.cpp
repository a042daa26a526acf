#include "rbvi/rom/law/reduced_law.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/largest.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// Greedy cones can have a generator that depends on the others: its coefficient is any; this
/// chooses one, far below all tolerances.
constexpr double ridge = 1e-12;

} // namespace

Matrix multiplier_coefficients(const MultiplierBasis &basis) {
  const Matrix &a = basis.normal, &b = basis.tangential;
  Matrix result = Matrix::Zero(a.rows() + b.rows(), a.cols() + b.cols());
  result.topLeftCorner(a.rows(), a.cols()) = a;
  result.bottomRightCorner(b.rows(), b.cols()) = b;
  return result;
}

CollocatedProblem collocated_problem(const MultiplierBasis &basis, const LawAtMu &law) {
  const Matrix functions = multiplier_coefficients(basis);
  const Matrix y = law.body->half_response(law.b.transpose() * functions);
  Matrix h = y.transpose() * y;
  h.diagonal() *= 1 + ridge;
  const std::vector<Index> nodes(basis.nodes.begin(), basis.nodes.end());
  std::vector<Index> rows; // of the tangential multipliers that collocation nodes have
  for (const Index node : nodes)
    rows.push_back(law.laws.tangent[node] - law.laws.nodes());
  return {h, functions.transpose() * law.q, basis.normal(nodes, Eigen::all),
          basis.tangential(rows, Eigen::all), bounds_at(law.laws.bound, nodes)};
}

double natural_residual(const Vector &x, const Vector &w, const Vector &diagonal,
                        const NodeLaws &laws) {
  const Vector bounds = bounds_of(laws, x), y = x - w.cwiseQuotient(diagonal);
  double largest = 0;
  const auto compare = [&](Index row, double projected) {
    largest = larger(largest, std::abs(x[row] - projected));
  };
  for (Index i = 0; i < laws.nodes(); ++i) {
    const Index normal = laws.normal[i];
    compare(normal, std::max(0.0, y[normal]));
    if (!laws.has_tangent(i)) continue;
    const Index tangent = laws.tangent[i];
    compare(tangent, std::clamp(y[tangent], -bounds[i], bounds[i]));
  }
  const double size = x.cwiseAbs().maxCoeff();
  return size > 0 ? largest / size : largest;
}

CollocatedResult solve_reduced_law(const MultiplierBasis &basis, const LawAtMu &law,
                                   const Vector &start) {
  CollocatedResult found = solve_collocated(collocated_problem(basis, law), start);
  if (!found.converged)
    throw failure("the reduced law of contact is not solved: " + found.reason +
                  "; reduce again with -multiplier_reduction condensed, or with more functions");
  return found;
}

} // namespace rbvi
