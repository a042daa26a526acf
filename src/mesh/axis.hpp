// The axis x = 0 of bodies that are turned about it.
#pragma once

#include "rbvi/mesh/mesh.hpp"

namespace rbvi {

/// Whether a coordinate x is 0 but for the round-off of a mesh of this extent.
inline bool on_axis(double x, double extent) {
  return std::abs(x) <= 1e-9 * extent;
}

/// Makes the boundary axis_of_turning of the nodes at x = 0; there need not be any. Throws
/// bad_input for a node on the other side. Collective.
void mark_axis(Mesh &mesh);

} // namespace rbvi
