// The problem of nonnegative_qp.hpp with some variables of either sign,
//
//   min of  1/2 |Y x - c|^2 + g . x   over x_1, ..., x_{r-k} >= 0 and x_{r-k+1}, ..., x_r free.
//
// The free ones are eliminated by an orthogonal projection: with Q R the QR of their columns F,
// w = R^-T g_F, and B the other columns,
//
//   min over x_B >= 0 of  1/2 |(I - Q Q^T)(B x_B - c)|^2 + (g_B - B^T Q w) . x_B,
//   x_F = R^-1 (Q^T (c - B x_B) - w).
#pragma once

#include "rbvi/method/nonnegative_qp.hpp"

namespace rbvi {

/// Exact and warm-started like NonnegativeQp, which it is where k = 0.
class MixedQp {
public:
  /// `free`: k, the number of columns at the end of Y whose coefficients take either sign.
  explicit MixedQp(Index rows, Index free = 0);
  /// Y has changed: forgets its factorisations, keeps the active set as the next starting guess.
  void reset();
  /// Starts from these columns instead, and which they are now: as NonnegativeQp.
  void start_from(std::vector<Index> active) { qp_.start_from(std::move(active)); }
  const std::vector<Index> &active() const { return qp_.active(); }
  /// `y`: rows x r with r >= k, c, g (empty: zero). Free columns that depend on others get the
  /// coefficient 0, or prove that the minimum is -infinity. Throws failure if the sizes do not fit.
  NonnegativeQpReport solve(const Matrix &y, const Vector &c, const Vector &g = {});
  const Vector &x() const { return free_ > 0 ? x_ : qp_.x(); }
  const Vector &residual() const { return free_ > 0 ? residual_ : qp_.residual(); } ///< c - Y x

private:
  void eliminate(const Matrix &y);

  Index free_;
  NonnegativeQp qp_;
  bool stale_ = true;
  Matrix q_, r_;    ///< QR of the independent free columns; r_ upper trapezoidal, rank x k
  Matrix bounded_;  ///< (I - Q Q^T) B
  Matrix coupling_; ///< Q^T B
  Eigen::PermutationMatrix<Eigen::Dynamic> order_; ///< order of the free columns in the QR
  Vector x_, residual_;
};

} // namespace rbvi
