// The history of friction: the slip that the steps before have left, which is data of a solve and
// is never kept by an interface. It is one value for each tangential row of the stacked dual,
// interface after interface, in metres: the mean over the dual function, so that it can be carried
// to another mu. With it the tangential rows of g are
//
//   g_tau = g_tau at rest + weight * slip before,   and B_tau u - g_tau is the slip since then.
//
// Empty: the bodies were at rest. Models reduced are those of one step from rest.
#pragma once

#include "rbvi/contact/contact.hpp"

namespace rbvi {

/// Number of tangential rows of the stacked dual.
Index tangential_size(const Contact &contact);

/// Throws bad_input for a history of another size, or one that is not finite.
void check_history(const Contact &contact, const Vector &slip);

/// What a history adds to g, all dual rows; `weights`: of all normal multipliers.
Vector added_by_history(const Contact &contact, const Vector &slip, const Vector &weights);

/// ContactInterface::nodal_at of the nodal interface, with a history.
NodalEvaluation nodal_with_history(const Contact &contact, const FullMu &mu, const Vector &slip,
                                   const Vector &weights);

/// The history that a solution leaves: `excess` is its B u - g, all dual rows, with the history
/// `before` in g. Zero where a multiplier has no weight.
Vector slip_of(const Contact &contact, const Vector &excess, const Vector &weights,
               const Vector &before);

} // namespace rbvi
