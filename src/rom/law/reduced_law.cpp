#include "rbvi/rom/law/reduced_law.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/law/general_lcp.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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

/// Some rows, or entries; zero where there is none.
template <class Dense> Dense with_zeros(const Dense &values, const std::vector<Index> &rows) {
  Dense result = Dense::Zero(std::ssize(rows), values.cols());
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (rows[k] >= 0) result.row(static_cast<Index>(k)) = values.row(rows[k]);
  return result;
}

Matrix sum_of(const std::vector<Matrix> &terms, const Vector &coefficients) {
  Matrix sum = coefficients[0] * terms[0];
  for (std::size_t t = 1; t < terms.size(); ++t)
    sum += coefficients[static_cast<Index>(t)] * terms[t];
  return sum;
}

/// The rows of some nodes; zero where a node has none.
Matrix tangential_rows(const Matrix &tangential, const NodeLaws &laws,
                       const std::vector<int> &nodes) {
  std::vector<Index> rows;
  for (const int node : nodes)
    rows.push_back(
        laws.has_tangent(node) ? laws.tangent[static_cast<std::size_t>(node)] - laws.nodes() : -1);
  return with_zeros(tangential, rows);
}

/// Zero where a node has no tangential multiplier.
std::vector<FrictionBound> bounds_at(const NodeLaws &laws, const std::vector<int> &nodes) {
  std::vector<FrictionBound> bounds;
  for (const int node : nodes)
    bounds.push_back(laws.has_tangent(node) ? laws.bound[static_cast<std::size_t>(node)]
                                            : FrictionBound{});
  return bounds;
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
          tangential_rows(basis.tangential, body.laws, basis.nodes),
          bounds_at(body.laws, basis.nodes)};
}

double natural_residual(const Vector &x, const Vector &w, const Vector &diagonal,
                        const NodeLaws &laws) {
  const Vector bounds = bounds_of(laws, x), y = x - w.cwiseQuotient(diagonal);
  double largest = 0;
  const auto compare = [&](Index row, double projected) {
    largest = larger(largest, std::abs(x[row] - projected));
  };
  for (Index i = 0; i < laws.nodes(); ++i) {
    const Index normal = laws.normal[static_cast<std::size_t>(i)];
    compare(normal, std::max(0.0, y[normal]));
    if (!laws.has_tangent(i)) continue;
    const Index tangent = laws.tangent[static_cast<std::size_t>(i)];
    compare(tangent, std::clamp(y[tangent], -bounds[i], bounds[i]));
  }
  const double size = x.cwiseAbs().maxCoeff();
  return size > 0 ? largest / size : largest;
}

ReducedLaw::ReducedLaw(const NodalLaw &law, ColumnLaws columns, bool b_separates)
    : law_(law), columns_(std::move(columns)) {
  if (law.reduction == MultiplierReduction::collocated) return;
  set_functions();
  if (!b_separates) return;
  const Index m = functions_.rows();
  for (Index t = 0; t < law.condensed.terms.cols(); ++t) {
    const Matrix term = law.condensed.terms.col(t).reshaped(m, m);
    terms_.push_back(tested(term * functions_));
    if (law.reduction == MultiplierReduction::joint)
      diagonals_.push_back(with_zeros(Vector(term.diagonal()), rows_));
  }
}

/// D of cones: lambda_n = Y a and lambda_tau = slip (bound - T c), the bound of each interface by
/// Coulomb's columns (nu_F times those of lambda_n) and one for Tresca's threshold.
void ReducedLaw::set_functions() {
  const MultiplierBasis &basis = law_.basis;
  const NodeLaws &laws = columns_.laws;
  if (law_.reduction == MultiplierReduction::joint) {
    functions_.resize(laws.rows, basis.normal.cols());
    functions_.topRows(laws.nodes()) = basis.normal;
    if (basis.tangential.size() > 0)
      functions_.bottomRows(basis.tangential.rows()) = basis.tangential;
    rows_.assign(basis.nodes.begin(), basis.nodes.end());
    for (const int node : basis.nodes)
      rows_.push_back(laws.tangent[static_cast<std::size_t>(node)]);
    return;
  }
  const std::vector<Index> nodes = nodes_with_tangent(laws);
  const Index generators = basis.normal.cols(), left = basis.tangential.cols();
  Matrix bounds(std::ssize(nodes), 0);
  int last = -1;
  for (const Index node : nodes) {
    const int interface = columns_.interface_of[static_cast<std::size_t>(node)];
    if (std::exchange(last, interface) == interface) continue;
    groups_.push_back(node);
    const Index first = bounds.cols();
    bounds.conservativeResizeLike(Matrix::Zero(bounds.rows(), first + generators + 1));
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if (columns_.interface_of[static_cast<std::size_t>(nodes[k])] != interface) continue;
      const auto row = static_cast<Index>(k);
      bounds.row(row).segment(first, generators) = basis.slip[row] * basis.normal.row(nodes[k]);
      bounds(row, first + generators) = basis.slip[row];
    }
  }
  Matrix tangential(std::ssize(nodes), bounds.cols() + left);
  tangential.leftCols(bounds.cols()) = bounds;
  if (left > 0) tangential.rightCols(left) = basis.slip.asDiagonal() * basis.tangential;
  functions_ = block_diagonal(basis.normal, tangential);
}

Matrix ReducedLaw::tested(const Matrix &image) const {
  if (law_.reduction == MultiplierReduction::cones) return functions_.transpose() * image;
  return with_zeros(image, rows_);
}

Matrix ReducedLaw::operator_at(const BodyAtMu &body, const CondensedProduct &times_h) const {
  return terms_.empty() ? tested(times_h(functions_)) : sum_of(terms_, body.terms);
}

/// H_jj at the nodes; 1 where there is no row.
Vector ReducedLaw::diagonal_at(const BodyAtMu &body, const CondensedProduct &times_h) const {
  const auto count = static_cast<Index>(rows_.size());
  Vector diagonal = Vector::Zero(count);
  for (std::size_t t = 0; t < diagonals_.size(); ++t)
    diagonal += body.terms[static_cast<Index>(t)] * diagonals_[t];
  if (terms_.empty()) {
    Matrix units = Matrix::Zero(functions_.rows(), count);
    for (Index k = 0; k < count; ++k)
      if (const Index row = rows_[static_cast<std::size_t>(k)]; row >= 0) units(row, k) = 1;
    diagonal = with_zeros(times_h(units), rows_).diagonal();
  }
  return (diagonal.array() > 0).select(diagonal, 1);
}

ReducedLawAnswer ReducedLaw::solve_cones(const BodyAtMu &body, const CondensedProduct &times_h,
                                         const ReducedLawStart &start) const {
  const Index r = law_.basis.normal.cols(), s = law_.basis.tangential.cols();
  const Matrix h = operator_at(body, times_h);
  // Coefficients of D from z = (a, c): (a, then nu_F a and t of each interface, -c).
  Matrix combine = Matrix::Zero(functions_.cols(), r + s);
  combine.topLeftCorner(r, r).setIdentity();
  combine.bottomRightCorner(s, s) = -Matrix::Identity(s, s);
  Vector fixed = Vector::Zero(functions_.cols());
  Index first = r;
  for (const Index node : groups_) {
    const FrictionBound &bound = body.laws.bound[static_cast<std::size_t>(node)];
    combine.block(first, 0, r, r) = bound.coefficient * Matrix::Identity(r, r);
    fixed[first + r] = bound.threshold;
    first += r + 1;
  }
  const auto by_cones = [&](const auto &values) { // by Y and by -slip T
    Matrix result(r + s, values.cols());
    result << values.topRows(r), -values.bottomRows(s);
    return result;
  };
  const Vector load = functions_.transpose() * body.q + h * fixed;
  Matrix m = by_cones(Matrix(h * combine));
  m.diagonal() *= 1 + ridge;
  const GeneralLcpResult found = solve_general_lcp(m, by_cones(load), start.active);
  if (!found.converged) not_solved(found.reason);
  return {functions_ * (combine * found.z + fixed), 0, found.iterations, {{}, found.active, {}}};
}

ReducedLawAnswer ReducedLaw::solve_joint(const BodyAtMu &body, const CondensedProduct &times_h,
                                         const ReducedLawStart &start) const {
  const MultiplierBasis &basis = law_.basis;
  const auto count = static_cast<Index>(basis.nodes.size());
  const Matrix rows = operator_at(body, times_h), values = with_zeros(functions_, rows_);
  const Vector diagonal = diagonal_at(body, times_h), q = with_zeros(body.q, rows_);
  const LeastSquaresResult found = solve_least_squares(
      {values.topRows(count), values.bottomRows(count), rows.topRows(count), rows.bottomRows(count),
       q.head(count), q.tail(count), diagonal.head(count), diagonal.tail(count),
       bounds_at(body.laws, basis.nodes)},
      start.states);
  if (!found.converged) not_solved(found.reason);
  return {functions_ * found.y, found.residual, found.iterations, {{}, {}, found.states}};
}

ReducedLawAnswer ReducedLaw::solve(const BodyAtMu &body, const CondensedProduct &times_h,
                                   const ReducedLawStart &start) const {
  if (law_.reduction == MultiplierReduction::cones) return solve_cones(body, times_h, start);
  if (law_.reduction == MultiplierReduction::joint) return solve_joint(body, times_h, start);
  const MultiplierBasis &basis = law_.basis;
  const CollocatedResult found = solve_collocated(collocated_problem(basis, body), start.x);
  if (!found.converged) not_solved(found.reason);
  return {multiplier_coefficients(basis) * found.x,
          found.residual,
          found.iterations,
          {found.x, {}, {}}};
}

} // namespace rbvi
