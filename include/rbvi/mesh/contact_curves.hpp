// Boundaries with contact in two dimensions: chains of their edges, found by the facets.
#pragma once

#include "rbvi/mesh/mesh.hpp"

namespace rbvi {

/// The pieces of a boundary with contact, those with the lower vertices first; a closed one begins
/// at its lowest vertex. Throws bad_input, naming `source`, where it meets itself.
std::vector<CurvePiece> curve_pieces(const SerialMesh &mesh, const std::string &boundary,
                                     const std::string &source);

/// The boundaries of a scene with contact along them; none but in two dimensions.
std::vector<std::string> contact_curves(const Scene &scene);

} // namespace rbvi
