// Decompositions that tests compare with, compiled once: each takes long to compile.
#pragma once

#include "rbvi/core/dense.hpp"

namespace rbvi {

struct ThinSvd {
  Vector values; ///< decreasing
  Matrix left;   ///< rows x min(rows, columns)
};

/// By one-sided rotations.
ThinSvd thin_svd(const Matrix &matrix);

/// Eigenvalues of a symmetric matrix, increasing.
Vector symmetric_eigenvalues(const Matrix &matrix);

/// Eigenvalues of a x = theta b x, a symmetric, b also positive definite; increasing.
Vector generalised_eigenvalues(const Matrix &a, const Matrix &b);

/// a^-1 b by complete pivoting.
Matrix solved(const Matrix &a, const Matrix &b);

/// The x of least |a x - b|, column by column; of all of them the smallest.
Matrix least_squares(const Matrix &a, const Matrix &b);

/// Numerical rank; `threshold` relative to the largest pivot, 0: round-off.
Index rank_of(const Matrix &matrix, double threshold = 0);

} // namespace rbvi
