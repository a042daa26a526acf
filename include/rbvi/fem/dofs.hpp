// Numbering of the displacement dofs: one per component and node.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/mesh/mesh.hpp"

#include <map>
#include <string>
#include <vector>

namespace rbvi {

/// A term of a that couples all dofs of some boundaries, by the sum of some means (Form::means).
/// Without means room for springs of free bodies, with values of zero.
struct Coupling {
  std::vector<Mean> means;
  std::vector<PetscInt> rows; ///< of all ranks, increasing
  std::vector<double> values; ///< of the functional there
};

/// A dof's natural number is natural_node * components + component. Matrices and vectors hold the
/// free dofs alone; the fixed ones are zero. All dofs that a boundary ties are one row, of the
/// lowest natural number among them.
struct Dofs {
  MPI_Comm comm = MPI_COMM_NULL;
  int components = 1;
  PetscInt total = 0;                  ///< all dofs, fixed ones included
  PetscInt total_free = 0;             ///< rows of the system
  PetscInt first_free = 0;             ///< first row owned by this rank
  std::vector<PetscInt> free;          ///< per local node * components + component: row or -1
  std::vector<PetscInt> natural_owned; ///< per owned row: its natural number
  /// Like `free`: number of the fixed boundary that imposes values on it (Cell::imposed_by), -1
  /// elsewhere; empty where no boundary does.
  std::vector<int> imposed_by;
  /// Natural numbers of the dofs that have no row of their own, and of those whose row they share;
  /// on every rank.
  std::map<PetscInt, PetscInt> tied;
  std::vector<Coupling> couplings; ///< see src/fem/means.hpp

  /// The natural number of the row of a dof, of a local node and a component.
  PetscInt natural(const Mesh &mesh, std::size_t node, int component) const {
    const PetscInt own = mesh.natural_node[node] * components + component;
    const auto found = tied.find(own);
    return found == tied.end() ? own : found->second;
  }
};

/// Collective. Throws bad_input for a component that the displacement does not have, and where what
/// is tied is fixed or tied a second time.
Dofs number_dofs(const Mesh &mesh, int components, const std::vector<FixedBoundary> &fixed,
                 const std::vector<TiedBoundary> &tied = {});

/// Collective. A zero vector of free dofs.
Handle<Vec> make_vector(const Dofs &dofs);

/// Collective. All dofs in natural order on every rank; fixed ones are zero.
Vector to_natural(const Dofs &dofs, Vec free);

/// The owned part of a natural field as a distributed vector. Collective.
Handle<Vec> from_natural(const Dofs &dofs, const Vector &natural);

} // namespace rbvi
