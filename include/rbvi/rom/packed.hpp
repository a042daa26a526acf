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

} // namespace rbvi
