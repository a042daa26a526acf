#include "linear_algebra.hpp"

#include <Eigen/Dense>

namespace rbvi {

ThinSvd thin_svd(const Matrix &matrix) {
  const Eigen::JacobiSVD<Matrix> svd(matrix, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.singularValues(), svd.matrixU()};
}

Vector symmetric_eigenvalues(const Matrix &matrix) {
  return Eigen::SelfAdjointEigenSolver<Matrix>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
}

Vector generalised_eigenvalues(const Matrix &a, const Matrix &b) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<Matrix>(a, b, Eigen::EigenvaluesOnly)
      .eigenvalues();
}

Matrix solved(const Matrix &a, const Matrix &b) {
  return Eigen::FullPivLU<Matrix>(a).solve(b);
}

Matrix least_squares(const Matrix &a, const Matrix &b) {
  return Eigen::CompleteOrthogonalDecomposition<Matrix>(a).solve(b);
}

Index rank_of(const Matrix &matrix, double threshold) {
  Eigen::ColPivHouseholderQR<Matrix> qr(matrix);
  if (threshold > 0) qr.setThreshold(threshold);
  return qr.rank();
}

} // namespace rbvi
