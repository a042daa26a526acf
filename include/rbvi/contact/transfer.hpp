// From the multipliers of one mesh to those of another of the same scene.
#pragma once

#include "rbvi/contact/contact.hpp"

namespace rbvi {

/// Values at the multipliers of `from`, such as FrictionResult::start, interpolated at those of
/// `to`: the mean of the nearest dual nodes, two on curves and three on surfaces, weighted by the
/// inverse squares of their distances. Exact where the nodes coincide. Throws failure if the
/// interfaces are not the same ones.
Vector transferred(const Contact &from, const Contact &to, const Vector &values);

} // namespace rbvi
