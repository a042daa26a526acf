// Boundaries with contact: in two dimensions chains of their edges, found by the facets; in three
// their rims.
#pragma once

#include "rbvi/mesh/mesh.hpp"

#include <iosfwd>

namespace rbvi {

/// The pieces of a boundary with contact, those with the lower vertices first; a closed one begins
/// at its lowest vertex. Throws bad_input, naming `source`, where it meets itself.
std::vector<CurvePiece> curve_pieces(const SerialMesh &mesh, const std::string &boundary,
                                     const std::string &source);

/// Mesh::open_rims of a boundary in three dimensions.
std::vector<PetscInt> open_rim(const SerialMesh &mesh, const std::string &boundary);

/// The boundaries of a scene with contact along them.
std::vector<std::string> contact_boundaries(const Scene &scene);

/// The boundaries with contact that turn smoothly and that no curve of the scene names, and how far
/// their edges are off the arcs through their vertices. Refined edges stay where they are.
std::vector<std::pair<std::string, double>> off_arcs(const SerialMesh &mesh, const Scene &scene);

/// Warns of them in the mesh of a file; "": built-in shapes know their curves.
void warn_of_edges(const Scene &scene, const std::string &file, std::ostream &out);

} // namespace rbvi
