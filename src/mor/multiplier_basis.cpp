#include "rbvi/mor/multiplier_basis.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/model/collocated_law.hpp"
#include "rbvi/mor/pod.hpp"
#include "rbvi/par/small_svd.hpp"

namespace rbvi {

namespace {

SparseMatrix block(const SparseMatrix &product, Index first, Index count) {
  return product.block(first, first, count, count);
}

/// Modes of snapshots, orthonormal in `product`: as few as hold the tolerance.
struct DenseModes {
  Matrix columns;
  std::vector<double> error; ///< e(n), n = 0, 1, ..., rank: root of sum of squares, relative
};

/// QR, then SVD of the small factor.
DenseModes dense_pod(const Matrix &snapshots, const SparseMatrix &product, double tolerance) {
  const Matrix factor = product_factor(product);
  const SmallSvd svd = small_svd(factor * snapshots);
  DenseModes modes;
  modes.error = projection_errors(svd.values);
  Index count = 1;
  while (count < svd.values.size() && modes.error[count] > tolerance)
    ++count;
  modes.columns = svd.left.leftCols(count);
  factor.triangularView<Eigen::Upper>().solveInPlace(modes.columns);
  return modes;
}

} // namespace

Matrix multiplier_functions(const Matrix &nodal, const MultiplierBasis &basis) {
  return nodal * multiplier_coefficients(basis);
}

MultiplierBases make_multiplier_basis(const Matrix &coefficients, Index normal,
                                      const SparseMatrix &product, double tangential,
                                      const ConeOptions &cone) {
  MultiplierBases bases;
  const Index tangents = coefficients.rows() - normal;
  const Matrix tractions = coefficients.bottomRows(tangents);
  if (tangents > 0 && tractions.isZero(0))
    throw failure("no snapshot has a tangential stress: use -multiplier_reduction condensed");
  Cone found = build_cone(coefficients.topRows(normal), block(product, 0, normal), cone);
  bases.basis.normal = std::move(found.basis.generators);
  bases.normal = std::move(found.history);
  if (tangents == 0) return bases;
  DenseModes modes = dense_pod(tractions, block(product, normal, tangents), tangential);
  bases.basis.tangential = std::move(modes.columns);
  bases.tangential = std::move(modes.error);
  return bases;
}

} // namespace rbvi
