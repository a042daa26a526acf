// The columns of H required so far: received, in order of arrival, each of them once; or those of a
// matrix that is there.
#pragma once

#include "rbvi/method/lcp.hpp"

#include <utility>
#include <vector>

namespace rbvi {

class LazyColumns {
public:
  LazyColumns(ColumnSource source, Index n)
      : source_(std::move(source)), h_(n, 0), slot_(n, -1), diagonal_(Vector::Zero(n)) {}
  explicit LazyColumns(const ScaledMatrix &whole)
      : data_(whole.matrix.data()), factor_(whole.factor), slot_(whole.matrix.rows(), -1),
        diagonal_(Vector::Zero(whole.matrix.rows())) {}

  /// Asks for those that are missing, in one call. Throws failure if what comes is of the wrong
  /// size or not finite.
  void require(const std::vector<Index> &which);
  bool has(Index i) const { return slot(i) >= 0; }
  auto column(Index i) const { return factor_ * Eigen::Map<const Vector>(entries(i), size()); }
  /// Those of column i, without the factor.
  const double *entries(Index i) const { return data_ + slot(i) * size(); }
  double factor() const { return factor_; }
  Index size() const { return diagonal_.size(); }
  /// H_jj; 0 where column j is not there.
  const Vector &diagonal() const { return diagonal_; }
  Matrix block(const std::vector<Index> &active) const;
  /// H(:, active) x and |H(:, active)| |x|.
  std::pair<Vector, Vector> multiply(const std::vector<Index> &active, const Vector &x) const;
  int count() const { return static_cast<int>(count_); }

private:
  Index slot(Index i) const { return slot_[i]; }
  /// Appends these columns to h_.
  void receive(const std::vector<Index> &fresh);

  ColumnSource source_; ///< empty: all of H is at data_
  Matrix h_;            ///< what was received
  const double *data_ = nullptr;
  double factor_ = 1;
  std::vector<Index> slot_;
  Vector diagonal_;
  Index count_ = 0;
};

} // namespace rbvi
