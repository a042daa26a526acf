#include "rbvi/core/error.hpp"
#include "rbvi/method/balance.hpp"

#include <Eigen/SVD>

#include <algorithm>
#include <vector>

namespace rbvi {

namespace {

/// Of motions: rows that are this much smaller resist by round-off.
constexpr double resists = 1e-8;

Matrix null_space(const Matrix &rows) {
  if (rows.rows() == 0) return Matrix::Identity(rows.cols(), rows.cols());
  const Eigen::JacobiSVD<Matrix, Eigen::FullPivHouseholderQRPreconditioner> svd(
      rows, Eigen::ComputeFullV);
  const Vector &values = svd.singularValues();
  const Index rank = (values.array() > resists * values[0]).count();
  return svd.matrixV().rightCols(rows.cols() - rank);
}

/// Of rows that resist motions, many or few.
Matrix null_space_of(const std::vector<Eigen::RowVectorXd> &rows, Index motions) {
  Matrix all(std::ssize(rows), motions);
  for (Index k = 0; k < all.rows(); ++k)
    all.row(k) = rows[k];
  return null_space(all.rows() > motions ? triangular_factor(all) : all);
}

} // namespace

Matrix unresisted_motions(const NodeLaws &laws, const Matrix &held) {
  std::vector<Eigen::RowVectorXd> rows;
  for (Index node = 0; node < laws.nodes(); ++node) {
    rows.emplace_back(held.row(laws.normal[node]));
    if (!laws.has_tangent(node) || !laws.bound[node].carries_traction(true)) continue;
    for (Index t = 0; t < laws.tangents; ++t)
      rows.emplace_back(held.row(laws.tangent[node] + t));
  }
  return null_space_of(rows, held.cols());
}

Matrix loose_motions(const NodeLaws &laws, const Matrix &held, const Vector &x) {
  constexpr double least = 1e-9; // of the largest pressure and of the bound
  double largest = 0;
  for (const Index row : laws.normal)
    largest = std::max(largest, x[row]);
  const Vector bounds = bounds_of(laws, x);
  std::vector<Eigen::RowVectorXd> rows;
  for (Index node = 0; node < laws.nodes(); ++node) {
    if (x[laws.normal[node]] > least * largest) rows.emplace_back(held.row(laws.normal[node]));
    if (!laws.has_tangent(node)) continue;
    const Index first = laws.tangent[node];
    const Vector traction = x.segment(first, laws.tangents);
    const double size = traction.norm();
    if (size < (1 - least) * bounds[node]) {
      for (Index t = 0; t < laws.tangents; ++t)
        rows.emplace_back(held.row(first + t));
    } else if (laws.free_at(node) == 2 && bounds[node] > least * largest) {
      // What moves a node across its slip turns its traction.
      rows.emplace_back((traction[0] * held.row(first + 1) - traction[1] * held.row(first)) / size);
    }
  }
  return null_space_of(rows, held.cols());
}

void check_held(const FreeMotions &motions, const MotionText &describe) {
  const Vector left = unbalanced_load(motions.laws, motions.held, motions.load, motions.terms);
  if (left.norm() > 0)
    throw failure(describe(left) + ", and is pushed where no contact and no friction can hold it");
}

Vector balance_bodies(Vector beta, const HeldBodies &bodies) {
  HeldAnswer last{};
  const Balance balance = find_balance(std::move(beta), [&](const Vector &at) {
    const bool first = last.motions == nullptr;
    last = bodies.solve(at);
    const auto &[laws, held, load, terms, slope] = *last.motions;
    if (first) check_held(*last.motions, bodies.describe);
    return SpringState{last.lengths,
                       forces_on_motions(laws, held, terms, *last.x).maxCoeff() / bodies.stiffness,
                       slope.size() > 0 ? Matrix(-held.transpose() * slope) : Matrix()};
  });
  const auto motion = [&] { return bodies.describe(lu_solve(bodies.lengths, balance.excess)); };
  if (balance.flies)
    throw failure(motion() + ", and is pushed on where no contact and no friction can hold it");
  if (!balance.converged) {
    const std::string moved = motion();
    throw failure("the forces on bodies that contact alone holds do not balance in " +
                  std::to_string(balance.solves) + " solves: " + moved +
                  (moved.empty() ? "" : ": ") + bodies.advice);
  }
  const Matrix loose = loose_motions(last.motions->laws, last.motions->held, *last.x);
  if (loose.cols() > 0)
    throw failure(bodies.describe(loose) +
                  " at no cost at the answer, where no contact and no friction holds it");
  return balance.beta;
}

} // namespace rbvi
