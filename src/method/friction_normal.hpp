// Contact alone, of a problem with friction: where no bound is above zero, and where the rule that
// chooses one of several answers begins.
#pragma once

#include "friction_newton.hpp"

namespace rbvi::friction {

/// Of the rows x_n, node by node. `start`: of x, or empty.
LcpResult normal_contact(LazyColumns &h, const Vector &q, const NodeLaws &laws, const Vector &start,
                         const FrictionOptions &options);

/// The answer where every bound is zero.
FrictionResult without_friction(LazyColumns &h, const Vector &q, const NodeLaws &laws,
                                const Vector &start, const FrictionOptions &options);

} // namespace rbvi::friction
