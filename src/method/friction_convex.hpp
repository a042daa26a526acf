// With its bounds frozen (no coefficient), contact with friction is the minimum of the strictly
// convex 1/2 x.Hx + q.x over half-lines and disks: a projected Newton method (Bertsekas 1982). What
// a bound holds stays, all else takes the step of the linear system, each entry as far as its own
// bound, and all as far as the function falls on that bent way: in a soft layer that slides as one
// the node where the slip turns is found at once, where active sets move it node by node. Wherever
// a step is cut short, sweeps node by node follow, which alone converge.
#pragma once

#include "friction_newton.hpp"

namespace rbvi::friction {

/// Lowers the function from point.x (feasible, with its columns) until the laws hold to
/// `tolerance`, relative, or `steps` linear systems are used up; takes those off `steps`. False if
/// a system is not positive definite.
bool minimise(LazyColumns &h, const Vector &q, const NodeLaws &frozen, double tolerance, int &steps,
              State &point);

} // namespace rbvi::friction
