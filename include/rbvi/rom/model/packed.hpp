// Symmetric matrices as ReducedModel::a holds them: the lower triangle, column by column.
#pragma once

#include "rbvi/core/dense.hpp"

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

} // namespace rbvi
