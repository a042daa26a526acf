// Niakh (2022): (2.34).
#include "rbvi/mor/cones.hpp"

#include "cone_tools.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/method/mixed_qp.hpp"

#include <Eigen/Cholesky>

namespace rbvi {

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

Cone build_cone(const Matrix &snapshots, const SparseMatrix &product, const ConeOptions &options,
                const HoldingMultipliers &hold) {
  const Matrix thetas = checked(snapshots, product);
  if (options.type == ConeType::nodal) return nodal_cone(thetas, product, options);
  if (options.type == ConeType::hybrid) return hybrid_cone(thetas, product, options, hold);
  const std::string &name = cone_type_names()[static_cast<std::size_t>(options.type)];
  return entered(cone_makers(), options.type, "-cone_type " + name)(thetas, product, options);
}

std::map<ConeType, ConeMaker> &cone_makers() {
  static std::map<ConeType, ConeMaker> list;
  return list;
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
