// Between the rows of NodeLaws, in any order, and those of friction::Laws: x_n of all nodes, then
// x_tau of all nodes; those of nodes with a sign alone are zero, and never asked for.
#pragma once

#include "friction_newton.hpp"

namespace rbvi::friction {

class Order {
public:
  explicit Order(const NodeLaws &laws);
  Index size() const { return std::ssize(of_); }
  Index row(Index j) const { return of_[j]; } ///< of entry j; -1: none
  Vector inwards(const Vector &values) const; ///< empty remains so, here and there
  Vector outwards(const Vector &values) const;
  ColumnSource inwards(const ColumnSource &columns) const; ///< which must outlive it

private:
  Matrix reordered(const Matrix &values) const;

  Index rows_;
  std::vector<Index> of_; ///< row of each entry, -1: none
  bool same_;
};

Laws laws_of(const NodeLaws &of);

/// Fills in the list of nodes in contact and the states of all nodes.
void describe(FrictionResult &result, const Laws &laws, const ActiveSets &sets);

/// FrictionResult::start. `diagonal`: H_jj, 0: unknown.
Vector smooth_start(const Vector &diagonal, const Laws &laws, const State &point);

} // namespace rbvi::friction
