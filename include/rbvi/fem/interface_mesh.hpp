// The parts of the distributed mesh that contact interfaces are posed on, whole on every rank. They
// are small beside the domain, so that contact operators are assembled without communication and
// are bitwise the same for any number of ranks.
#pragma once

#include "rbvi/contact/interface.hpp"
#include "rbvi/fem/dofs.hpp"
#include "rbvi/fem/trace.hpp"

namespace rbvi {

struct InterfacePlaces {
  /// Of each contact of the scene. A Problem hands them over to its interfaces.
  std::vector<InterfaceMesh> meshes;
  std::vector<std::vector<PetscInt>> natural_nodes; ///< of their nodes
  std::vector<PetscInt> natural_dofs;               ///< of each contact dof
  Trace trace;                                      ///< contact dof -> displacement dof
};

/// Collective. Throws bad_input where a part of an interface is not there: no cell in a region, no
/// edge on a boundary, or a boundary that is fixed where its kernels ask for free displacements; for
/// curves in three dimensions; for a dof that two interfaces constrain.
InterfacePlaces place_interfaces(const Mesh &mesh, const Dofs &dofs, const Scene &scene);

} // namespace rbvi
