// Columns of a dense matrix, as the solvers ask for them.
#pragma once

#include "rbvi/method/friction.hpp"

#include <gtest/gtest.h>

#include <set>

namespace rbvi {

inline ColumnSource columns_of(const Matrix &h) {
  return [&h](const std::vector<Index> &which) { return Matrix(h(Eigen::all, which)); };
}

/// Hands out columns of a dense H and fails the test when one is asked for twice.
inline ColumnSource once(const Matrix &h, std::set<Index> &given) {
  return [&h, &given](const std::vector<Index> &which) {
    for (const Index i : which)
      EXPECT_TRUE(given.insert(i).second) << "column " << i << " asked for twice";
    return Matrix(h(Eigen::all, which));
  };
}

/// Nodes of one law, all x_n and then all x_tau.
inline FrictionResult solve_friction(const ColumnSource &columns, const Vector &q, int dim,
                                     const FrictionBound &bound, const Vector &start = {},
                                     const FrictionOptions &options = {}) {
  return solve_friction(columns, q, uniform_laws(q.size() / dim, dim, bound), start, options);
}

} // namespace rbvi
