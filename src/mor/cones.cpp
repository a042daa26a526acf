// Niakh (2022): (2.33), (2.34), (B.13)-(B.26).
#include "cone_tools.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/method/mixed_qp.hpp"

#include <Eigen/Cholesky>

#include <string>

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

} // namespace

Matrix Cone::all() const {
  Matrix result(basis.generators.rows(), size());
  result.leftCols(basis.generators.cols()) = basis.generators;
  if (modes.columns.cols() > 0) result.rightCols(modes.columns.cols()) = modes.columns;
  return result;
}

const std::vector<std::string> &cone_type_names() {
  static const std::vector<std::string> names{"cpg", "mcpg",  "angle_greedy",
                                              "nmf", "nodal", "hybrid"};
  return names;
}

Matrix product_factor(const SparseMatrix &product) {
  return cholesky(Matrix(product), "the inner product of the multipliers").transpose();
}

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

Cone build_cone(const Matrix &snapshots, const SparseMatrix &product, const ConeOptions &options,
                const HoldingMultipliers &hold) {
  const Matrix thetas = checked(snapshots, product);
  switch (options.type) {
  case ConeType::cpg:
  case ConeType::mcpg:
    return projected_greedy_cone(thetas, product, options);
  case ConeType::angle_greedy:
    return angle_greedy_cone(thetas, product, options);
  case ConeType::nmf:
    return nmf_cone(thetas, product, options);
  case ConeType::nodal:
    return nodal_cone(thetas, product, options);
  case ConeType::hybrid:
    return hybrid_cone(thetas, product, options, hold);
  }
  throw failure("this type of dual basis does not exist");
}

Vector distances_to_cone(const Matrix &values, const ConeBasis &basis, const SparseMatrix &product,
                         const FreeModes &modes) {
  const Matrix factor = product_factor(product);
  const Matrix targets = factor * values;
  const Index cone = basis.generators.cols(), free = modes.columns.cols();
  Matrix coordinates(factor.rows(), cone + free);
  coordinates.leftCols(cone) = factor * basis.generators;
  if (free > 0) coordinates.rightCols(free) = factor * modes.columns;
  const double scale = targets.colwise().norm().maxCoeff();
  if (scale == 0) return Vector::Zero(values.cols());
  Vector result(values.cols());
  MixedQp projection(factor.rows(), free);
  for (Index p = 0; p < values.cols(); ++p) {
    if (!projection.solve(coordinates, targets.col(p)).converged)
      throw failure("the projection of a multiplier onto the cone did not converge");
    result[p] = projection.residual().norm();
  }
  return result / scale;
}

} // namespace rbvi
