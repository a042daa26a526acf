// Singular values of small dense matrices by SLEPc (SVDLAPACK), with the number converged checked.
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

/// Serial. Throws failure if an entry is not finite or SLEPc does not return every triplet.
SmallSvd small_svd(const Matrix &matrix);

/// Singular values alone, decreasing. Serial; throws like small_svd.
Vector singular_values(const Matrix &matrix);

} // namespace rbvi
