// The two curves along which bodies can meet, whole on every rank: their nodes carry the vertical
// displacements that the contact forms touch. Small beside the domain, so that the contact
// operators are assembled without communication and are bitwise the same for any number of ranks.
#pragma once

#include "rbvi/fem/dofs.hpp"
#include "rbvi/fem/trace.hpp"

namespace rbvi {

/// Nodes of the slave curve, vertices and then middles of edges, each by increasing x, then those
/// of the master curve. Contact dof i is the vertical displacement of node i.
struct ContactCurves {
  Index slave_nodes = 0;
  std::vector<PetscInt> natural_node;
  std::vector<Point> points; ///< reference coordinates, middles brought onto the curve
  Trace trace;
};

/// For a scene with a pair. Collective. Throws bad_input where a curve has no edge, has two nodes
/// of the same x (it must be a graph over x), or has a fixed vertical displacement, and for three
/// dimensions.
ContactCurves make_contact_curves(const Mesh &mesh, const Dofs &dofs, const Scene &scene);

} // namespace rbvi
