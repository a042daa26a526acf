// Niakh (2022): (2.33), (2.34), (B.13)-(B.26).
#include "rbvi/mor/published/greedy_cones.hpp"

#include "greedy_cone.hpp"
#include "rbvi/core/error.hpp"
#include "reductions.hpp"

#include <Eigen/QR>

namespace rbvi {

namespace {

/// Lines 9 and 10 of Algorithm 2 up to the norm. What round-off left of an exact contact with the
/// bound is made zero, or it would forbid this generator below later snapshots.
Vector remainder(const Vector &theta, const GreedyCone &cone, const ConeOptions &options) {
  if (options.type == ConeType::cpg || cone.size() == 0) return theta;
  const double largest = theta.maxCoeff();
  const PartBelow part =
      largest_part_below(theta, options.feasibility * largest, cone.generators(),
                         cone.coordinates(), cone.targets().col(cone.farthest()));
  Vector left = theta - cone.generators() * part.coefficients;
  left(part.touching).setZero();
  return (left.array() > 1e-13 * largest).select(left, 0.0);
}

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

Cone projected_greedy_cone(const Matrix &snapshots, const SparseMatrix &product,
                           const ConeOptions &options) {
  // Clipping leaves the span of the snapshots.
  const bool clips = options.type == ConeType::mcpg && options.feasibility > 0;
  GreedyCone cone(snapshots, clips ? product_factor(product) : span_coordinates(snapshots, product),
                  options);
  while (!cone.finished()) {
    const Index selected = cone.farthest();
    cone.add(remainder(snapshots.col(selected), cone, options), selected);
  }
  return cone.take();
}

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
