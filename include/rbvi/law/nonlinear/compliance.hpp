// The compliance C of an elastic body on its contact dofs, a column when it is required.
#pragma once

#include "rbvi/core/dense.hpp"

#include <vector>

namespace rbvi {

/// C, column by column. Columns that are not required need not exist.
class ComplianceColumns {
public:
  /// Contact dofs one after another.
  struct Range {
    Index first, count;
    bool operator==(const Range &) const = default;
  };
  virtual ~ComplianceColumns() = default;
  virtual Index size() const = 0; ///< contact dofs
  /// Makes these columns exist.
  virtual void require(const std::vector<Index> &dofs) = 0;
  virtual Eigen::Map<const Vector> column(Index dof) const = 0;
  /// Its column is zero at the other dofs.
  virtual Range body_of(Index) const { return {0, size()}; }
};

} // namespace rbvi
