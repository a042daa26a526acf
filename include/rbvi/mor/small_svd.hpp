// Singular values of small dense matrices by SLEPc (SVDLAPACK), with the number converged checked.
#pragma once

#include "rbvi/core/dense.hpp"

namespace rbvi {

struct SmallSvd {
  Vector values; ///< decreasing, min(rows, cols) of them
  Matrix left, right;
};

/// Serial. Throws failure if SLEPc does not return every triplet.
SmallSvd small_svd(const Matrix &matrix);

/// Singular values alone, decreasing.
Vector singular_values(const Matrix &matrix);

} // namespace rbvi
