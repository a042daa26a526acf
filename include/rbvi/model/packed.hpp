// Symmetric matrices as BodyModel::a holds them: the lower triangle, column by column.
#pragma once

#include "rbvi/core/dense.hpp"

#include <vector>

namespace rbvi {

/// Fills the lower triangle of a square matrix.
inline void unpack(const Eigen::Ref<const Vector> &packed, Matrix &lower) {
  const Index n = lower.rows();
  for (Index j = 0, at = 0; j < n; at += n - j, ++j)
    lower.col(j).tail(n - j) = packed.segment(at, n - j);
}

/// The whole matrix of order n.
inline Matrix unpacked(const Eigen::Ref<const Vector> &packed, Index n) {
  Matrix result(n, n);
  unpack(packed, result);
  result.triangularView<Eigen::StrictlyUpper>() = result.transpose();
  return result;
}

/// The lower triangle of a square matrix.
inline Vector pack(const Matrix &square) {
  const Index n = square.rows();
  Vector packed(n * (n + 1) / 2);
  for (Index j = 0, at = 0; j < n; at += n - j, ++j)
    packed.segment(at, n - j) = square.col(j).tail(n - j);
  return packed;
}

// Symmetric matrices of order n that are zero outside of the same diagonal blocks, one for each
// body. `squares`: n^2 x count, each a column of its entries, column by column.

/// The orders of as many blocks as there are, from the first rows on; one of order n where there is
/// no matrix that is not zero between two of them.
std::vector<int> diagonal_blocks(const Matrix &squares);

/// The lower triangles of these blocks, one behind the other.
Matrix pack_blocks(const Matrix &squares, const std::vector<int> &blocks);

/// The whole matrices again. Throws bad_input where the numbers of entries do not agree.
Matrix unpacked_blocks(const Matrix &packed, const std::vector<int> &blocks);

} // namespace rbvi
