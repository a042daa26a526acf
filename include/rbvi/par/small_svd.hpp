// Singular values of small dense matrices by SLEPc (SVDLAPACK), with the number converged checked.
// One SVD object for each prefix serves all calls of a process.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/par/petsc.hpp"

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

} // namespace rbvi
