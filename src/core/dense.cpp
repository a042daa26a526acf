#include "rbvi/core/dense.hpp"

#include "rbvi/core/error.hpp"

#include <algorithm>
#include <string>

namespace Eigen {
template class LLT<MatrixXd>;
template class PartialPivLU<MatrixXd>;
template class HouseholderSequence<MatrixXd, VectorXd>;
template class HouseholderQR<MatrixXd>;
template class ColPivHouseholderQR<MatrixXd>;
template class SelfAdjointEigenSolver<MatrixXd>;
} // namespace Eigen

namespace rbvi {

bool cholesky_in_place(Matrix &matrix) {
  const Eigen::LLT<Eigen::Ref<Matrix>> factor(matrix);
  return factor.info() == Eigen::Success && matrix.diagonal().allFinite();
}

Matrix cholesky(Matrix matrix, std::string_view what) {
  if (!cholesky_in_place(matrix)) throw failure(std::string(what) + " is not positive definite");
  matrix.triangularView<Eigen::StrictlyUpper>().setZero();
  return matrix;
}

namespace {

template <class Triangle> void solve_in_place(const Triangle &triangle, Eigen::Ref<Matrix> x) {
  if (x.cols() == 1) {
    Eigen::Map<Vector> only(x.data(), x.rows());
    triangle.solveInPlace(only);
  } else if (x.size() > 0) {
    triangle.solveInPlace(x);
  }
}

} // namespace

void solve_lower(const Matrix &lower, Eigen::Ref<Matrix> x) {
  solve_in_place(lower.triangularView<Eigen::Lower>(), x);
}

void solve_lower_transposed(const Matrix &lower, Eigen::Ref<Matrix> x) {
  solve_in_place(lower.triangularView<Eigen::Lower>().transpose(), x);
}

Vector cholesky_solve(const Matrix &lower, const Vector &right) {
  Vector x = right;
  solve_lower(lower, x);
  solve_lower_transposed(lower, x);
  return x;
}

Matrix solve_upper(const Matrix &upper, Matrix x) {
  if (x.size() > 0) upper.triangularView<Eigen::Upper>().solveInPlace(x);
  return x;
}

ThinQr thin_qr(const Matrix &matrix) {
  const Eigen::HouseholderQR<Matrix> qr(matrix);
  const Index size = std::min(matrix.rows(), matrix.cols());
  return {qr.householderQ() * Matrix::Identity(matrix.rows(), size),
          qr.matrixQR().topRows(size).triangularView<Eigen::Upper>()};
}

Matrix triangular_factor(const Matrix &matrix) {
  const Eigen::HouseholderQR<Matrix> qr(matrix);
  return qr.matrixQR()
      .topRows(std::min(matrix.rows(), matrix.cols()))
      .triangularView<Eigen::Upper>();
}

EigenPairs eigen_pairs(const Matrix &matrix) {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(matrix);
  if (solver.info() != Eigen::Success || !solver.eigenvalues().allFinite())
    throw failure("the eigenvalues of a symmetric matrix did not converge");
  return {solver.eigenvalues(), solver.eigenvectors()};
}

EigenPairs eigen_pairs(const Matrix &a, const Matrix &b) {
  if (Matrix lower = b; !cholesky_in_place(lower)) return {};
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(a, b);
  if (solver.info() != Eigen::Success) return {};
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Matrix lu_solve(const Matrix &matrix, const Matrix &right) {
  return Eigen::PartialPivLU<Matrix>(matrix).solve(right);
}

} // namespace rbvi
