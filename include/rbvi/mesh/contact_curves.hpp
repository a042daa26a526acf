// Contact along boundaries in two dimensions sorts their nodes by x.
#pragma once

#include "rbvi/mesh/mesh.hpp"

namespace rbvi {

/// Throws bad_input, naming `source`, for a boundary with contact that is not one graph over x: in
/// several pieces, upright somewhere, or twice above the same x.
void check_contact_curves(const SerialMesh &mesh, const Scene &scene, const std::string &source);

} // namespace rbvi
