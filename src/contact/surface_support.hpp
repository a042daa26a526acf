// Contact of a surface in space with something rigid by multipliers (contact/support.hpp).
#pragma once

#include "rbvi/contact/support.hpp"

namespace rbvi {

/// `mesh`: triangles of one boundary. Multipliers are continuous and linear on them, at each vertex
/// a normal one and, with friction, one along each tangent of its frame (frames.hpp). Integrals are
/// over the mapped flat triangles, by Radon's points or by vertices. Throws bad_input for contact
/// that follows the displacement, and where the mesh is no surface.
std::unique_ptr<ContactInterface> surface_support(const Scene &scene, InterfaceMesh mesh,
                                                  const RigidContact &rigid);

} // namespace rbvi
