// Bodies that nothing holds: A is singular there.
#pragma once

#include "rbvi/fem/dofs.hpp"

namespace rbvi {

/// Throws bad_input on every rank where imposed displacements and terms of a leave a connected part
/// of the mesh a rigid motion, naming the part and the motion; of a displacement of one component
/// the constant, otherwise translations and rotations. No contact counts: it pushes only. What a
/// holds is asked at one point of the box, where displacements alone leave a motion. Collective.
void check_held(const Scene &scene, const Mesh &mesh, const Dofs &dofs);

} // namespace rbvi
