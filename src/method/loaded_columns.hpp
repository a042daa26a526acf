// What loads on an elastic body move: columns of its compliance, each times its load.
#pragma once

#include "rbvi/method/compliance.hpp"

#include <algorithm>

namespace rbvi {

class LoadedColumns {
public:
  /// `column`: of all contact dofs, zero outside of `rows`; must outlive this.
  void add(double load, const double *column, Compliance::Range rows) {
    columns_.push_back({load, column, rows});
  }
  /// Adds the columns of the loads that are not 0, one for each contact dof.
  void add(const Vector &loads, const Compliance &compliance) {
    for (Index dof = 0; dof < loads.size(); ++dof)
      if (loads[dof] != 0) add(loads[dof], compliance.column(dof).data(), compliance.body_of(dof));
  }
  /// Takes what they move from these entries of u. Four columns of one body at a time, for which u
  /// is read and written once.
  void subtract_from(Eigen::Ref<Vector> u, Compliance::Range within) const {
    for (std::size_t k = 0; k < columns_.size();) {
      const auto rows = columns_[k].rows;
      const Index first = std::max(rows.first, within.first);
      const Index count = std::min(rows.first + rows.count, within.first + within.count) - first;
      const auto moved = [&](std::size_t of) {
        return columns_[of].load * Eigen::Map<const Vector>(columns_[of].column + first, count);
      };
      const bool four = k + 4 <= columns_.size() &&
                        std::all_of(&columns_[k], &columns_[k] + 4,
                                    [&](const Loaded &other) { return other.rows == rows; });
      if (count > 0 && four)
        u.segment(first, count) -= moved(k) + moved(k + 1) + moved(k + 2) + moved(k + 3);
      else if (count > 0)
        u.segment(first, count) -= moved(k);
      k += four ? 4 : 1;
    }
  }

private:
  struct Loaded {
    double load;
    const double *column;
    Compliance::Range rows;
  };
  std::vector<Loaded> columns_;
};

} // namespace rbvi
