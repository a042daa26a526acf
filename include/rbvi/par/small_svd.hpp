// Singular values of small dense matrices, and eigenpairs of symmetric ones, by SLEPc (SVDLAPACK,
// EPSLAPACK), with the number converged checked.
// One SVD object for each prefix serves all calls of a process.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/par/petsc.hpp"

#include <string>

namespace rbvi {

/// A copy as a sequential dense PETSc matrix, for SLEPc's small factors.
Handle<Mat> sequential_dense(const Matrix &matrix);

struct SmallSvd {
  Vector values;      ///< k = min(rows, cols) of them, decreasing
  Matrix left, right; ///< rows x k, cols x k, orthonormal columns
};

/// Serial. `prefix`: of the options of SLEPc's SVD ("infsup_": -infsup_svd_view, ...); "": none are
/// read. Where LAPACK does not converge Eigen does. Throws failure if an entry is not finite or
/// SLEPc does not return every triplet.
SmallSvd small_svd(const Matrix &matrix, const char *prefix = "");

/// Singular values alone, decreasing. Serial; throws like small_svd.
Vector singular_values(const Matrix &matrix, const char *prefix = "");

/// An SVD as these functions use it, its options read. Throws failure for a value that SLEPc
/// refuses.
Handle<SVD> make_small_svd(const char *prefix);

/// One EPS for matrices of any size, one after the other. Serial.
class SmallEigen {
public:
  /// `prefix`: of its options ("pga_": -pga_eps_view, ...). Throws failure for a value that SLEPc
  /// refuses.
  explicit SmallEigen(const char *prefix);

  /// All n eigenvalues, decreasing; the lower triangle of `matrix` (n x n) is read. Throws failure
  /// if an entry is not finite or SLEPc does not return every pair.
  Vector values(const Matrix &matrix);

  /// Eigenvectors of the first `count` of them, n x count, orthonormal columns.
  Matrix vectors(Index count) const;

private:
  std::string prefix_;
  Handle<EPS> eps_;
  Index size_ = 0; ///< of the last matrix
};

} // namespace rbvi
