// The parts of the distributed mesh that contact interfaces are posed on, whole on every rank. They
// are small beside the domain, so that contact operators are assembled without communication and
// are bitwise the same for any number of ranks.
// The contact side over the ranks, for solvers that condense nothing: B is a PETSc matrix, dual x
// free displacement dofs, and g, the weights and multipliers are vectors of its rows. A dual node
// belongs to the rank that owns it in the mesh, and its multipliers are successive rows there: the
// normal one, then the tangential ones. ContactOperators of a single rank number them otherwise
// (DualSpace::gram), which `rows` of the layout translates.
#pragma once

#include "rbvi/contact/contact.hpp"
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
/// edge on a boundary, or a boundary that is fixed where its kernels ask for free displacements;
/// for curves in three dimensions; for a dof that two interfaces constrain.
InterfacePlaces place_interfaces(const Mesh &mesh, const Dofs &dofs, const Scene &scene);

struct DualLayout {
  MPI_Comm comm = MPI_COMM_NULL;
  std::vector<WantedNodes> own;  ///< per interface: its nodes that belong to this rank
  std::vector<Index> nodes;      ///< those, over all interfaces (NodeLaws)
  std::vector<Index> rows;       ///< this rank's multipliers, by their rows in ContactOperators::b
  std::vector<PetscInt> numbers; ///< of all those rows: the rows of the distributed B
  std::vector<PetscInt> columns; ///< of all contact dofs: the free displacement dofs
  PetscInt local_columns = 0;    ///< free displacement dofs of this rank
};

/// Collective. Nodes that are none of the mesh (macro-edges) are shared in equal parts.
DualLayout share_dual(const Contact &contact, const InterfacePlaces &places, const Mesh &mesh,
                      const Dofs &dofs);

struct DistributedContact {
  Handle<Mat> b;
  Handle<Vec> g;
  Handle<Vec> weights; ///< of the node of each multiplier
  NodeLaws laws;       ///< of this rank's multipliers, numbered from 0
};

/// Those of this rank's multipliers, numbered from 0 in the order of the layout.
NodeLaws own_laws(const DualLayout &layout, const NodeLaws &laws);

/// This rank's rows of a matrix whose rows are those of B, in the order of the layout.
SparseMatrix own_rows(const DualLayout &layout, const SparseMatrix &of_multipliers);

/// A matrix of any number of rows, each of one rank, on contact dofs: as one on the free
/// displacement dofs. Collective.
Handle<Mat> distribute_rows(const DualLayout &layout, const SparseMatrix &own);

/// Rows of which each rank has some, on every rank: row k of `own` is row `numbers`[k] of all.
/// Collective.
SparseMatrix gather_rows(MPI_Comm comm, const SparseMatrix &own, const std::vector<Index> &numbers,
                         Index all);

/// Collective. `operators`: at least the rows of this rank; `laws`: of all nodes.
DistributedContact distribute(const DualLayout &layout, const ContactOperators &operators,
                              const NodeLaws &laws);

/// The Gram matrix of W, dual x dual. Collective.
Handle<Mat> distribute(const DualLayout &layout, const SparseMatrix &w_product);

/// From this rank's values of any number of rows. Collective.
Handle<Vec> distribute_values(MPI_Comm comm, const Vector &own);

/// All multipliers, from every rank onto the ranks and back. Collective.
Handle<Vec> distribute(const DualLayout &layout, const Vector &multipliers);
Vector on_every_rank(const DualLayout &layout, Vec multipliers);
/// From this rank's. Collective.
Vector on_every_rank(const DualLayout &layout, const Vector &own);

/// Collective. `operators` of one interface: from this rank's rows to all of them on every rank.
/// Its nodal constraint is one of the dual nodes (ContactInterface::can_be_split).
void gather_rows(const DualLayout &layout, const Contact &contact, std::size_t interface,
                 ContactOperators &operators);

} // namespace rbvi
