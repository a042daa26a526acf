// Columns of a dense matrix, as the solvers ask for them.
#pragma once

#include "rbvi/law/lcp.hpp"

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

} // namespace rbvi
