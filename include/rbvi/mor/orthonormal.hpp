// Orthonormal columns on one core that grow; those of a basis over the ranks: pod.hpp.
#pragma once

#include "rbvi/core/dense.hpp"

#include <vector>

namespace rbvi {

class OrthonormalColumns {
public:
  /// Q^T P Q = I. `product`, P, must outlive this; null: the identity.
  explicit OrthonormalColumns(const SparseMatrix *product = nullptr) : product_(product) {}
  const Matrix &columns() const { return columns_; } ///< Q, rows x size; 0 x 0 before append()
  Matrix coordinates(const Matrix &x) const;         ///< Q^T P x
  Matrix remainder(Matrix x) const;                  ///< x - Q Q^T P x
  /// Appends what the columns of a block have beside Q and those before them, but for those of
  /// which no more than `tolerance` of their norm is left. Throws failure for entries that are not
  /// finite.
  void append(const Matrix &block, double tolerance);

private:
  const SparseMatrix *product_;
  Matrix columns_;
};

/// Orthonormal columns that span those of `vectors`, without columns of which 1e-12 is left beside
/// those before them: rows x rank.
Matrix orthonormal_range(const Matrix &vectors);

} // namespace rbvi
