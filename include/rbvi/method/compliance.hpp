// The compliance C = E^T A^-1 E of an elastic body on its contact dofs: a column is made when it is
// first required, and kept. What stands behind contact is this for a full body, for one of which a
// part is scaled and for a reduced one; with B it gives the condensed operator H = B C B^T.
#pragma once

#include "rbvi/core/dense.hpp"

#include <vector>

namespace rbvi {

class Compliance {
public:
  /// Contact dofs one after another.
  struct Range {
    Index first, count;
    bool operator==(const Range &) const = default;
  };
  /// `size`: contact dofs.
  explicit Compliance(Index size) : size_(size), slot_(size, -1) {}
  virtual ~Compliance() = default;
  Compliance(const Compliance &) = delete;
  Compliance &operator=(const Compliance &) = delete;

  Index size() const { return size_; }
  Index count() const { return count_; } ///< columns that are there
  /// Makes these columns exist. Collective where the body is.
  void require(const std::vector<Index> &dofs);
  /// Throws failure for one that was not required.
  Eigen::Map<const Vector> column(Index dof) const;
  /// C B^T(:, which), size() x which.size(); columns as require() does. Collective likewise.
  virtual Matrix moved(const SparseMatrix &b, const std::vector<Index> &which);
  /// -C `reaction`, by the columns of entries that are not zero, as require() makes them.
  Vector displaced_by(const Vector &reaction);
  /// The column of this dof is zero at the other dofs.
  virtual Range body_of(Index) const { return {0, size_}; }

protected:
  /// The columns of these dofs, size() x dofs.size().
  virtual void make(const std::vector<Index> &dofs, Eigen::Ref<Matrix> columns) = 0;
  /// C is another one.
  void forget();
  /// All columns at once.
  void set_all(Matrix columns);

private:
  Index size_, count_ = 0;
  Matrix columns_;          ///< size x room
  std::vector<Index> slot_; ///< per dof: its column, -1 if it has none yet
};

/// B C B^T(:, which), rows of B x which.size(): the constraint values that unit multipliers cause.
Matrix condensed_columns(Compliance &compliance, const SparseMatrix &b,
                         const std::vector<Index> &which);

} // namespace rbvi
