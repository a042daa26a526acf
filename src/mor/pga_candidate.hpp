// One training parameter of the projected greedy, and the space that all of them are compared with.
#pragma once

#include "rbvi/par/small_svd.hpp"

namespace rbvi {

constexpr double pga_tie = 1e-10; ///< values that differ by less, relative, count as equal

/// V_N + S in coordinates, and the supremizers that made it.
struct PgaSpace {
  Index contact, modes, size;
  Matrix columns; ///< storage for all, `size` of them in use
  Matrix sources; ///< contact x supremizers: unit vectors of S_R(mu) before projection

  auto in_use() const { return columns.leftCols(size); }

  /// (I - Pi) of vectors with contact coordinates alone.
  Matrix remainder(const Matrix &top) const;

  /// Adds the normalised remainder of a unit vector with contact coordinates alone.
  void add(const Vector &source);
  /// Adds what is left of a unit vector, which is known: orthogonal to all but round-off of the
  /// modes, and to the supremizers before it.
  void take(const Vector &source, const Vector &left);
};

/// One training parameter: sigma^2 is the largest eigenvalue of gram = range^T (I - Pi) range, of
/// which the lower triangle is kept.
class PgaCandidate {
public:
  /// `supremizers`: T(mu) X, n_c x R.
  explicit PgaCandidate(Matrix supremizers) : range_(std::move(supremizers)) {}

  /// A number that sigma is not below, by a few power iterations from the last direction.
  double lower_bound(const PgaSpace &space);

  /// Whether sigma is below `needed`, by a Cholesky factorisation: many times cheaper than the
  /// eigenvalue, and all that most candidates need. false: it may be.
  bool certainly_below(const PgaSpace &space, double needed);

  /// sigma itself.
  double evaluate(const PgaSpace &space, SmallEigen &eigen);

  /// Unit vectors of S_R(mu) that are farthest from the space as `evaluate` found it: one, or all
  /// of a multiple eigenvalue.
  const Matrix &farthest() const { return farthest_; }

private:
  void update(const PgaSpace &space);
  void refresh(const PgaSpace &space);

  Matrix range_; // orthonormal columns that span S_R(mu); T(mu) X until it is first needed
  Matrix gram_, farthest_;
  Vector direction_; // unit vector, towards an eigenvector of the largest eigenvalue
  double built_ = 1; // norm of gram when it was last computed afresh
  Index seen_ = -1;  // columns of the space in gram; -1: range is still T(mu) X
};

} // namespace rbvi
