// Exact, warm-started active-set solver of the small dense problem
//
//   min over x >= 0 of  1/2 |Y x - c|^2 + g . x          Y: m x r, c: m, g: r
//
// With g = 0 it is the projection of c onto the cone spanned by the columns of Y (NNLS); with
// Y = L^-1 B^T, c = L^-1 f, A = L L^T it is the dual of  min 1/2 a(u,u) - f(u), B u <= g.
// Works on QR coordinates (never on Y^T Y alone) and is rank-revealing: a column that depends on
// the active ones is not taken in with them.
#pragma once

#include "rbvi/core/dense.hpp"

#include <vector>

namespace rbvi {

/// Q R of a growing and shrinking set of columns: append by twice-repeated Gram-Schmidt, remove by
/// Givens rotations.
class UpdatableQr {
public:
  explicit UpdatableQr(Index rows, Index capacity = 0);
  Index rows() const { return q_.rows(); }
  Index size() const { return size_; }
  /// Appends `column`; returns false, and changes nothing, if its remainder orthogonal to the
  /// columns present is below `tolerance` times its norm.
  bool append(const Eigen::Ref<const Vector> &column, double tolerance);
  /// Removes the column at `position` (0 .. size-1); later ones move up.
  void remove(Index position);
  auto q() const { return q_.leftCols(size_); }                    ///< rows x size, orthonormal
  auto r() const { return r_.topLeftCorner(size_, size_); }        ///< upper triangular

private:
  Matrix q_, r_;
  Index size_ = 0;
};

struct NonnegativeQpOptions {
  double tolerance = 1e-13;           ///< on the gradient, relative to |y_j| (|c| + |Y x|) + |g_j|
  double dependence = 1e-10;          ///< below this relative remainder a column is dependent
  int max_iterations = 0;             ///< 0: 20 * (columns + 10)
};

struct NonnegativeQpReport {
  int iterations = 0;  ///< columns taken in or dropped
  bool converged = false;
  bool unbounded = false; ///< the constraints B u <= g of the primal problem contradict each other
};

/// Holds the active set between calls, so that a slowly changing problem costs a few updates.
/// The columns of Y may grow in number between calls (a greedy basis); those present must not
/// change unless `reset` is called.
class NonnegativeQp {
public:
  explicit NonnegativeQp(Index rows, NonnegativeQpOptions options = {});
  /// Forgets the factorisation but keeps the active set as the next starting guess.
  void reset();
  /// Starts from this active set (column numbers, in order) instead of the kept one.
  void start_from(std::vector<Index> active);
  /// Solves for Y, c and g (g empty: zero). x has one entry per column of Y.
  NonnegativeQpReport solve(const Eigen::Ref<const Matrix> &y, const Eigen::Ref<const Vector> &c,
                            const Vector &g = {});
  const Vector &x() const { return x_; }
  const Vector &residual() const { return residual_; } ///< c - Y x
  const std::vector<Index> &active() const { return active_; }

private:
  UpdatableQr qr_;
  NonnegativeQpOptions options_;
  std::vector<Index> active_;
  Vector x_, residual_;
};

} // namespace rbvi
