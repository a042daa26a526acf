// The greedy of cones from snapshots (CPG), and what keeps its remainders non-negative (mCPG).
#pragma once

#include "rbvi/mor/cones.hpp"

namespace rbvi {

/// Largest part of theta that a cone represents from below.
struct PartBelow {
  Vector coefficients;         ///< a >= 0, one per generator
  std::vector<Index> touching; ///< nodes where the bound is active
};

/// Line 9 of Algorithm 2: a >= 0 that minimises |theta - N a|_W under theta - N a >= -slack at
/// every node; N = `generators`, `coordinates` = U N, `target` = U theta with |U .| the norm of W.
/// Where theta + slack is zero no generator that is positive may take part. Exact, by the dual of
/// a least-distance problem. Throws failure if that does not converge.
PartBelow largest_part_below(const Vector &theta, double slack, const Matrix &generators,
                             const Matrix &coordinates, const Vector &target);

} // namespace rbvi
