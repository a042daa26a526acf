// Numbering of the displacement dofs: one per component and node.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/mesh/mesh.hpp"

#include <string>
#include <vector>

namespace rbvi {

/// A dof's natural number is natural_node * components + component. Matrices and vectors hold the
/// free dofs alone; the fixed ones are zero.
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
  /// Rows that something beside cells couples with each other, lists of them, on every rank.
  std::vector<std::vector<PetscInt>> coupled{};
};

/// Collective. Throws bad_input for a component that the displacement does not have.
Dofs number_dofs(const Mesh &mesh, int components, const std::vector<FixedBoundary> &fixed);

/// Collective. A zero vector of free dofs.
Handle<Vec> make_vector(const Dofs &dofs);

/// Collective. All dofs in natural order on every rank; fixed ones are zero.
Vector to_natural(const Dofs &dofs, Vec free);

/// The owned part of a natural field as a distributed vector. Collective.
Handle<Vec> from_natural(const Dofs &dofs, const Vector &natural);

} // namespace rbvi
