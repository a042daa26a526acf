#include "rbvi/rom/law/reduced_law.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/law/general_lcp.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// Greedy cones can have a generator that depends on the others: its coefficient is any; this
/// chooses one, far below all tolerances.
constexpr double ridge = 1e-12;

[[noreturn]] void not_solved(const std::string &reason) {
  throw failure("the reduced law of contact is not solved: " + reason +
                "; reduce again with -multiplier_reduction condensed, or with more functions");
}

Matrix block_diagonal(const Matrix &a, const Matrix &b) {
  Matrix result = Matrix::Zero(a.rows() + b.rows(), a.cols() + b.cols());
  result.topLeftCorner(a.rows(), a.cols()) = a;
  result.bottomRightCorner(b.rows(), b.cols()) = b;
  return result;
}

/// D of cones: lambda_n = Y a and lambda_tau = slip (bound - T c), the bound by Coulomb's columns
/// (nu_F times those of lambda_n) and one for Tresca's threshold.
Matrix functions_of_cones(const MultiplierBasis &basis) {
  const Index nodes = basis.normal.rows(), generators = basis.normal.cols();
  Matrix tangential(nodes, generators + 1 + basis.tangential.cols());
  tangential << basis.slip.asDiagonal() * basis.normal, basis.slip,
      basis.slip.asDiagonal() * basis.tangential;
  return block_diagonal(basis.normal, tangential);
}

Matrix sum_of(const std::vector<Matrix> &terms, const Vector &coefficients) {
  Matrix sum = coefficients[0] * terms[0];
  for (std::size_t t = 1; t < terms.size(); ++t)
    sum += coefficients[static_cast<Index>(t)] * terms[t];
  return sum;
}

} // namespace

Matrix multiplier_coefficients(const MultiplierBasis &basis) {
  return block_diagonal(basis.normal, basis.tangential);
}

CollocatedProblem collocated_problem(const MultiplierBasis &basis, const BodyAtMu &body) {
  const Matrix functions = multiplier_coefficients(basis);
  const Matrix y = body.stiffness->half_response(body.b.transpose() * functions);
  Matrix h = y.transpose() * y;
  h.diagonal() *= 1 + ridge;
  return {h, functions.transpose() * body.q, basis.normal(basis.nodes, Eigen::all),
          basis.tangential(basis.nodes, Eigen::all), body.bound};
}

double natural_residual(const Vector &x, const Vector &w, const Vector &diagonal, Index normal,
                        const FrictionBound &bound) {
  const Vector bounds = values_of(bound, x.head(normal));
  const Vector y = x - w.cwiseQuotient(diagonal);
  double largest = 0;
  for (Index i = 0; i < x.size(); ++i) {
    const double s = i < normal ? 0 : bounds[i - normal];
    const double projected = i < normal ? std::max(0.0, y[i]) : std::clamp(y[i], -s, s);
    largest = std::max(largest, std::abs(x[i] - projected));
  }
  const double size = x.cwiseAbs().maxCoeff();
  return size > 0 ? largest / size : largest;
}

ReducedLaw::ReducedLaw(const NodalLaw &law) : law_(law) {
  const MultiplierBasis &basis = law.basis;
  const Index nodes = law.normal, m = 2 * nodes;
  if (law.reduction == MultiplierReduction::collocated) return;
  const bool cones = law.reduction == MultiplierReduction::cones;
  if (cones) {
    functions_ = functions_of_cones(basis);
  } else {
    functions_.resize(m, basis.normal.cols());
    functions_ << basis.normal, basis.tangential;
  }
  std::vector<Index> rows(basis.nodes.begin(), basis.nodes.end());
  for (const int node : basis.nodes)
    rows.push_back(nodes + node);
  for (Index t = 0; t < law.condensed.terms.cols(); ++t) {
    const Matrix term = law.condensed.terms.col(t).reshaped(m, m);
    const Matrix product = term * functions_;
    terms_.push_back(cones ? Matrix(functions_.transpose() * product)
                           : Matrix(product(rows, Eigen::all)));
    if (!cones) diagonals_.push_back(term.diagonal()(rows));
  }
}

ReducedLawAnswer ReducedLaw::solve_cones(const BodyAtMu &body) {
  const Index r = law_.basis.normal.cols(), s = law_.basis.tangential.cols();
  const Matrix h = sum_of(terms_, body.terms);
  // Coefficients of D from z = (a, c): (a, nu_F a, t, -c).
  Matrix combine = Matrix::Zero(2 * r + 1 + s, r + s);
  combine.topLeftCorner(r, r).setIdentity();
  combine.block(r, 0, r, r) = body.bound.coefficient * Matrix::Identity(r, r);
  combine.bottomRightCorner(s, s) = -Matrix::Identity(s, s);
  Vector fixed = Vector::Zero(2 * r + 1 + s);
  fixed[2 * r] = body.bound.threshold;
  const auto tested = [&](const auto &values) { // by Y and by -slip T
    Matrix result(r + s, values.cols());
    result << values.topRows(r), -values.bottomRows(s);
    return result;
  };
  const Vector load = functions_.transpose() * body.q + h * fixed;
  Matrix m = tested(Matrix(h * combine));
  m.diagonal() *= 1 + ridge;
  const GeneralLcpResult found = solve_general_lcp(m, tested(load), last_active_);
  if (!found.converged) not_solved(found.reason);
  last_active_ = found.active;
  return {functions_ * (combine * found.z + fixed), 0, found.iterations};
}

ReducedLawAnswer ReducedLaw::solve_joint(const BodyAtMu &body) {
  const MultiplierBasis &basis = law_.basis;
  const auto count = static_cast<Index>(basis.nodes.size());
  const Matrix rows = sum_of(terms_, body.terms);
  Vector diagonal = Vector::Zero(2 * count);
  for (std::size_t t = 0; t < diagonals_.size(); ++t)
    diagonal += body.terms[static_cast<Index>(t)] * diagonals_[t];
  const auto q_n = body.q.head(law_.normal), q_t = body.q.tail(law_.normal);
  const LeastSquaresResult found = solve_least_squares(
      {basis.normal(basis.nodes, Eigen::all), basis.tangential(basis.nodes, Eigen::all),
       rows.topRows(count), rows.bottomRows(count), q_n(basis.nodes), q_t(basis.nodes),
       diagonal.head(count), diagonal.tail(count), body.bound},
      last_states_);
  if (!found.converged) not_solved(found.reason);
  last_states_ = found.states;
  return {functions_ * found.y, found.residual, found.iterations};
}

ReducedLawAnswer ReducedLaw::solve(const BodyAtMu &body) {
  if (law_.reduction == MultiplierReduction::cones) return solve_cones(body);
  if (law_.reduction == MultiplierReduction::joint) return solve_joint(body);
  const MultiplierBasis &basis = law_.basis;
  const CollocatedResult found = solve_collocated(collocated_problem(basis, body), last_);
  if (!found.converged) not_solved(found.reason);
  last_ = found.x;
  return {multiplier_coefficients(basis) * found.x, found.residual, found.iterations};
}

} // namespace rbvi
