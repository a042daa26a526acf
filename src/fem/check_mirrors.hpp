#pragma once

#include "rbvi/fem/problem.hpp"

namespace rbvi {

/// Throws bad_input where the mesh does not end at a plane of symmetry of the scene, where the map
/// or the motion moves the plane, or where a node of an elastic body can leave it. Collective.
void check_mirrors(const Problem &problem);

} // namespace rbvi
