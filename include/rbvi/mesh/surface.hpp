// The surface of a mesh, with its groups and what a scene says nothing of: no condition, no load,
// no contact.
#pragma once

#include "rbvi/mesh/mesh.hpp"

namespace rbvi {

struct MeshSurface {
  std::vector<std::array<int, 3>> facets;          ///< decreasing vertices, the rest -1
  std::map<std::string, std::vector<bool>> groups; ///< per boundary of the mesh: those in it
  std::vector<bool> free; ///< those in no boundary of a condition, a load or a contact
};

/// The mesh of a scene before it is refined, built in or from a file, with all named groups of that
/// file. Throws bad_input (see make_mesh).
SerialMesh mesh_with_groups(const Scene &scene, const std::string &file);

MeshSurface surface_of(const SerialMesh &mesh, const Scene &scene);

/// What is free: "left", "arc (64 of 100 facets)", "12 facets in no group, in [0.3, 0.7] x [0, 1]".
std::vector<std::string> free_parts(const SerialMesh &mesh, const MeshSurface &surface);

} // namespace rbvi
