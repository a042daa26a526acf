// The few displacement dofs that the contact forms touch: distributed vectors on one side,
// replicated dense ones on the other.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/fem/dofs.hpp"
#include "rbvi/par/petsc.hpp"

#include <vector>

namespace rbvi {

/// E: n_c unit columns. Each rank lists the contact dofs that it owns.
struct Trace {
  MPI_Comm comm = MPI_COMM_NULL;
  PetscInt size = 0;               ///< n_c, the same on every rank
  std::vector<PetscInt> local_row; ///< owned free dof, local number (0 = first owned)
  std::vector<PetscInt> index;     ///< its contact dof number, 0 .. n_c - 1
};

/// `natural`: the natural number of each contact dof, each a free one. Not collective.
Trace make_trace(const Dofs &dofs, const std::vector<PetscInt> &natural);

/// Some of the contact dofs, numbered in the order of `dofs`. Not collective.
Trace part_of(const Trace &trace, const std::vector<Index> &dofs);

/// Collective. The row of each contact dof, on every rank; `first`: this rank's first row.
std::vector<PetscInt> global_rows(const Trace &trace, PetscInt first);

/// Collective. E^T u, on every rank.
Vector restrict_to(const Trace &trace, Vec u);

/// Collective. E^T M for a dense distributed matrix: n_c x columns, on every rank.
Matrix restrict_to(const Trace &trace, Mat dense);

/// f += E values. Not collective (each rank adds to the rows it owns).
void add_extension(const Trace &trace, const Eigen::Ref<const Vector> &values, Vec f);

/// M = E values (n_c x columns) as a dense distributed matrix with the row layout of `like`; values
/// of dofs that repeat add up.
/// Collective.
Handle<Mat> extension(const Trace &trace, const Matrix &values, Mat like);

} // namespace rbvi
