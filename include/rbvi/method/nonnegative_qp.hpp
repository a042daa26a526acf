// Exact, warm-started active-set solver of the small dense problem
//
//   min over x >= 0 of  1/2 |Y x - c|^2 + g . x          Y: m x r, c: m, g: r
//
// With g = 0 it is the projection of c onto the cone spanned by the columns of Y (NNLS); with
// Y = L^-1 B^T, c = L^-1 f, A = L L^T it is the dual of  min 1/2 a(u,u) - f(u), B u <= g; with
// Y = G^T it is the dual of the least-distance problem  min 1/2 |z - c|^2, G z <= g, whose solution
// is z = residual().
// Works on QR coordinates (never on Y^T Y alone) of columns scaled to unit norm, and is
// rank-revealing: a column that depends on the active ones replaces one of them, or proves that the
// minimum is -infinity, or is left out. Method: Lawson and Hanson (1974), chapter 23, with a linear
// term; the objective falls with every column that enters, so that no active set returns.
#pragma once

#include "rbvi/core/dense.hpp"

#include <cstdint>
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
  /// columns present is not above `tolerance` times its norm.
  bool append(const Eigen::Ref<const Vector> &column, double tolerance);
  /// Replaces everything by the QR of `columns` (unit norm), in one block. Returns false, and is
  /// then empty, if they are too close to dependent for that (a remainder below about 1e-6).
  bool assign(const Eigen::Ref<const Matrix> &columns);
  /// Removes the column at `position` (0 .. size-1); later ones move up.
  void remove(Index position);
  void clear() { size_ = 0; }
  auto q() const { return q_.leftCols(size_); }             ///< rows x size, orthonormal
  auto r() const { return r_.topLeftCorner(size_, size_); } ///< upper triangular

private:
  void reserve(Index capacity);
  Matrix q_, r_;
  Vector projection_;
  Index size_ = 0;
};

struct NonnegativeQpOptions {
  double tolerance = 1e-13;  ///< on the gradient, relative to |y_j| (|c| + |Y x|) + |g_j|
  double dependence = 1e-10; ///< at or below this relative remainder a column is dependent
  int max_iterations = 0;    ///< 0: 20 * (columns + 10)
};

struct NonnegativeQpReport {
  int iterations = 0; ///< columns taken in or dropped after the start
  bool converged = false;
  bool unbounded = false; ///< the constraints B u <= g of the primal problem contradict each other
};

/// Holds the active set between calls, so that a slowly changing problem costs a few updates.
/// The columns of Y may grow in number between calls (a greedy basis); those present must not
/// change unless `reset` is called. c and g may change freely.
class NonnegativeQp {
public:
  explicit NonnegativeQp(Index rows, NonnegativeQpOptions options = {});
  /// Forgets the factorisation but keeps the active set as the next starting guess.
  void reset();
  /// Starts from this active set (column numbers, in order) instead of the kept one. Numbers that
  /// are no column of the next Y are ignored. Implies `reset`.
  void start_from(std::vector<Index> active);
  /// Solves for Y, c and g (g empty: zero). x has one entry per column of Y. Throws failure if the
  /// sizes do not fit. Without convergence x, residual and active are those of the last step.
  NonnegativeQpReport solve(const Eigen::Ref<const Matrix> &y, const Eigen::Ref<const Vector> &c,
                            const Vector &g = {});
  const Vector &x() const { return x_; }
  const Vector &residual() const { return residual_; } ///< c - Y x
  const std::vector<Index> &active() const { return active_; }

private:
  using Columns = Eigen::Ref<const Matrix>;
  void prepare(const Columns &y, const Vector &g);
  void factorise(const Columns &y);
  void minimise(const Eigen::Ref<const Vector> &c);
  void drop(Index position);
  void drop_zeros(Index blocking);
  void take(Index column, double value);
  void drop_negative(const Eigen::Ref<const Vector> &c);
  void settle(const Eigen::Ref<const Vector> &c);
  Index best_column(const Columns &y, const Eigen::Ref<const Vector> &c);
  bool enter(const Columns &y, Index column);
  bool exchange(Index column);
  bool seen_before();

  NonnegativeQpOptions options_;
  NonnegativeQpReport report_;
  UpdatableQr qr_;
  std::vector<Index> active_; ///< columns in the order of the QR
  bool stale_ = false;        ///< the QR is not that of active_
  Vector norms_;              ///< norms of the columns of Y
  Vector linear_;             ///< g_j / |y_j|
  Vector values_;             ///< |y_j| x_j of the active columns, in the order of the QR
  Vector minimiser_;          ///< the values at the minimum over the active columns
  Vector image_;              ///< Q^T Y x at that minimum
  Vector gains_;              ///< minus the gradient, per unit column
  double banned_gain_ = 0;    ///< largest gain, relative to its scale, of a banned column
  Vector x_, residual_, column_;
  std::vector<char> status_;        ///< may enter, active, or banned until the next progress
  std::vector<std::uint64_t> seen_; ///< hashes of the active sets whose minimum was reached
};

} // namespace rbvi
