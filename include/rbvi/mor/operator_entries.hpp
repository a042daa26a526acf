// The entries of the operators that empirical interpolation takes as vectors: keys and values.
#pragma once

#include "rbvi/fem/problem.hpp"
#include "rbvi/mor/eim.hpp"
#include "rbvi/par/petsc.hpp"

namespace rbvi {

/// The local entries of the lower triangle of a symmetric matrix over the free dofs, by natural
/// numbers, and where their values stand.
class LowerTriangle {
public:
  /// Collective. Of the pattern of `a`.
  LowerTriangle(Mat a, const Dofs &dofs);
  const std::vector<EntryKey> &keys() const { return keys_; }
  /// In the order of keys(). `a`: of the same pattern.
  Vector values(Mat a) const;

private:
  std::vector<EntryKey> keys_;
  std::vector<bool> taken_;
};

/// All stored entries, row by row.
std::vector<EntryKey> nonzero_keys(const SparseMatrix &matrix);
Vector nonzero_values(const SparseMatrix &matrix);

} // namespace rbvi
