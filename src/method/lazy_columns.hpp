// The columns of H received so far, in order of arrival: each is asked for once.
#pragma once

#include "rbvi/method/lcp.hpp"

#include <utility>
#include <vector>

namespace rbvi {

class LazyColumns {
public:
  LazyColumns(const ColumnSource &source, Index n)
      : source_(source), h_(n, 0), slot_(n, -1), diagonal_(Vector::Zero(n)) {}

  /// Asks for those that are missing, in one call. Throws failure if what comes is of the wrong
  /// size or not finite.
  void require(const std::vector<Index> &which);
  bool has(Index i) const { return slot(i) >= 0; }
  auto column(Index i) const { return h_.col(slot(i)); }
  /// H_jj; 0 where column j is not there.
  const Vector &diagonal() const { return diagonal_; }
  Matrix block(const std::vector<Index> &active) const;
  /// H(:, active) x and |H(:, active)| |x|.
  std::pair<Vector, Vector> multiply(const std::vector<Index> &active, const Vector &x) const;
  int count() const { return static_cast<int>(count_); }

private:
  Index slot(Index i) const { return slot_[i]; }
  const ColumnSource &source_;
  Matrix h_;
  std::vector<Index> slot_;
  Vector diagonal_;
  Index count_ = 0;
};

} // namespace rbvi
