// Small dense and sparse matrices that one core holds whole, and their factors: compiled once, as
// each use of a decomposition costs more to compile than what is around it.
#pragma once

// Aligned alike under all flags: programs with others free memory that the library took.
#ifndef EIGEN_MAX_ALIGN_BYTES
#define EIGEN_MAX_ALIGN_BYTES 64
#define EIGEN_MAX_STATIC_ALIGN_BYTES 64
#endif

#include <Eigen/Dense>
#include <Eigen/SparseCore>

#include <string_view>

// For the few files that need more of a decomposition than the functions below.
namespace Eigen {
extern template class LLT<MatrixXd>;
extern template class PartialPivLU<MatrixXd>;
extern template class HouseholderSequence<MatrixXd, VectorXd>;
extern template class HouseholderQR<MatrixXd>;
extern template class ColPivHouseholderQR<MatrixXd>;
extern template class SelfAdjointEigenSolver<MatrixXd>;
} // namespace Eigen

namespace rbvi {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using SparseMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using Index = Eigen::Index;

/// L of L L^T = `matrix`, symmetric, whose lower triangle is read; it becomes L, and what is above
/// stays. Returns whether the matrix is positive definite.
bool cholesky_in_place(Matrix &matrix);
/// L, zero above the diagonal. Throws failure("`what` is not positive definite").
Matrix cholesky(Matrix matrix, std::string_view what);
/// x <- L^-1 x and x <- L^-T x, one or several columns; what is above the diagonal is not read.
void solve_lower(const Matrix &lower, Eigen::Ref<Matrix> x);
void solve_lower_transposed(const Matrix &lower, Eigen::Ref<Matrix> x);
/// (L L^T)^-1 `right`.
Vector cholesky_solve(const Matrix &lower, const Vector &right);
/// R^-1 X, R upper triangular; what is below the diagonal is not read.
Matrix solve_upper(const Matrix &upper, Matrix x);

/// m x n = Q R: Q m x k with orthonormal columns, R k x n upper triangular, k = min(m, n).
struct ThinQr {
  Matrix q, r;
};
ThinQr thin_qr(const Matrix &matrix);
/// R alone.
Matrix triangular_factor(const Matrix &matrix);

/// Columns of `vectors` belong to `values`, which increase.
struct EigenPairs {
  Vector values;
  Matrix vectors;
};
/// Of a symmetric matrix, of which the lower triangle is read. Throws failure if it does not
/// converge or is not finite.
EigenPairs eigen_pairs(const Matrix &matrix);
/// A v = value B v, v^T B v = 1, both symmetric, B positive definite; empty where it is not.
EigenPairs eigen_pairs(const Matrix &a, const Matrix &b);

/// A^-1 `right` of a square matrix, entries that are not finite where it is singular.
Matrix lu_solve(const Matrix &matrix, const Matrix &right);

} // namespace rbvi
