// Contact along boundaries in two dimensions sorts their nodes by x.
#pragma once

#include "rbvi/mesh/mesh.hpp"

namespace rbvi {

/// Throws bad_input, naming `source`, for a boundary with contact that is not one graph over x: in
/// several pieces, upright somewhere, or twice above the same x.
void check_contact_curves(const SerialMesh &mesh, const Scene &scene, const std::string &source);

/// The boundaries of a scene with contact along them; none but in two dimensions.
std::vector<std::string> contact_curves(const Scene &scene);

/// Whether the body ends at the first and at the last end of a boundary, by x: its surface turns
/// away there, at the foot of a block or on an axis of symmetry. Where it goes on smoothly, what is
/// beside the boundary would touch next.
std::array<bool, 2> closed_ends(const SerialMesh &mesh, const std::string &boundary);

} // namespace rbvi
