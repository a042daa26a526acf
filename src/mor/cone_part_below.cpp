#include "rbvi/core/error.hpp"
#include "rbvi/method/nonnegative_qp.hpp"
#include "rbvi/mor/cones.hpp"

#include <Eigen/QR>

#include <vector>

namespace rbvi {

namespace {

/// Generators that vanish wherever the bound does.
std::vector<Index> allowed_generators(const Vector &bound, const Matrix &generators) {
  std::vector<Index> allowed;
  for (Index k = 0; k < generators.cols(); ++k)
    if (!((bound.array() <= 0) && (generators.col(k).array() > 0)).any()) allowed.push_back(k);
  return allowed;
}

/// Upper triangular R and Q^T target of the columns Z = Q R. Dependent generators leave `a` open:
/// a ridge of 1e-6 then fixes it, and changes the squared distance by 1e-12 relative.
std::pair<Matrix, Vector> triangular_form(const Matrix &z, const Vector &target) {
  const Index rows = z.rows(), columns = z.cols();
  Matrix extended(rows + columns, columns);
  extended << z, Matrix::Zero(columns, columns);
  Vector right = Vector::Zero(rows + columns);
  right.head(rows) = target;
  for (;;) {
    const Eigen::HouseholderQR<Matrix> qr(extended);
    const Vector pivots = qr.matrixQR().diagonal().cwiseAbs();
    if (pivots.minCoeff() > 1e-7 * pivots.maxCoeff() || extended.bottomRows(columns).any()) {
      const Vector rotated = qr.householderQ().adjoint() * right;
      return {qr.matrixQR().topRows(columns).triangularView<Eigen::Upper>(), rotated.head(columns)};
    }
    extended.bottomRows(columns).diagonal().setConstant(1e-6 * pivots.maxCoeff());
  }
}

} // namespace

PartBelow largest_part_below(const Vector &theta, double slack, const Matrix &generators,
                             const Matrix &coordinates, const Vector &target) {
  const Vector bound = theta.array() + slack;
  PartBelow result{Vector::Zero(generators.cols()), {}};
  const std::vector<Index> allowed = allowed_generators(bound, generators);
  if (allowed.empty()) return result;
  const Index count = std::ssize(allowed);
  const Matrix n = generators(Eigen::all, allowed);
  const auto [r, z0] = triangular_form(coordinates(Eigen::all, allowed), target);

  std::vector<Index> nodes;
  for (Index i = 0; i < n.rows(); ++i)
    if ((n.row(i).array() > 0).any()) nodes.push_back(i);
  const Index rows = std::ssize(nodes);

  // In z = R a: min |z - z0| with N R^-1 z <= bound and -R^-1 z <= 0, of which the QP is the dual.
  Matrix y(count, rows + count);
  y << n(nodes, Eigen::all).transpose(), -Matrix::Identity(count, count);
  r.triangularView<Eigen::Upper>().transpose().solveInPlace(y);
  Vector g = Vector::Zero(rows + count);
  g.head(rows) = bound(nodes);
  // Near-dependent generators make y large, and the tolerance is relative to it.
  NonnegativeQp dual(count, {.tolerance = 1e-14});
  if (!dual.solve(y, z0, g).converged)
    throw failure("the part of a snapshot that the cone can represent from below was not found; "
                  "try -cone_type cpg");
  const Vector a = r.triangularView<Eigen::Upper>().solve(dual.residual());
  result.coefficients(allowed) = a.cwiseMax(0.0);
  for (const Index k : dual.active())
    if (k < rows) result.touching.push_back(nodes[k]);
  return result;
}

} // namespace rbvi
