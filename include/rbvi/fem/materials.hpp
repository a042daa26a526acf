// Which material of the scene each cell is of.
#pragma once

#include "rbvi/contact/interface.hpp"
#include "rbvi/mesh/mesh.hpp"

namespace rbvi {

/// The material of each cell of this rank, its number in scene.materials; empty: there is at most
/// one. Collective. Throws bad_input for a cell without one, or of two.
std::vector<int> materials_of_cells(const Scene &scene, const Mesh &mesh);

/// InterfaceMesh::materials. `of_cells`: materials_of_cells; `natural`: numbers of the nodes of the
/// interface. Collective.
std::vector<int> materials_of_entities(const Scene &scene, const Mesh &mesh,
                                       const std::vector<int> &of_cells,
                                       const InterfaceMesh &interface,
                                       const std::vector<PetscInt> &natural);

} // namespace rbvi
