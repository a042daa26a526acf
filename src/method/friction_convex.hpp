// With its bounds frozen (no coefficient), contact with friction is the minimum of the strictly
// convex 1/2 x.Hx + q.x over half-lines and disks. Newton steps, cut short where the minimum along
// them lies, and sweeps node by node wherever they are cut: every one lowers the function, and the
// sweeps alone converge.
#pragma once

#include "friction_newton.hpp"

namespace rbvi::friction {

/// Lowers the function from point.x (feasible, with its columns) until the laws hold to
/// `tolerance`, relative, or `steps` linear systems are used up; takes those off `steps`. False if
/// a system is not positive definite.
bool minimise(LazyColumns &h, const Vector &q, const Laws &frozen, double tolerance, int &steps,
              State &point);

} // namespace rbvi::friction
