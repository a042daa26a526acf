// The entries of a distributed sparse matrix on this rank.
#pragma once

#include "rbvi/par/petsc.hpp"

namespace rbvi {

/// Calls visitor(row, column, value) for each local entry. Not collective.
template <class Visitor> void visit_entries(Mat a, Visitor &&visitor) {
  PetscInt begin = 0, end = 0;
  RBVI_CALL(MatGetOwnershipRange(a, &begin, &end));
  for (PetscInt row = begin; row < end; ++row) {
    PetscInt count = 0;
    const PetscInt *columns = nullptr;
    const PetscScalar *values = nullptr;
    RBVI_CALL(MatGetRow(a, row, &count, &columns, &values));
    for (PetscInt k = 0; k < count; ++k)
      visitor(row, columns[k], values[k]);
    RBVI_CALL(MatRestoreRow(a, row, &count, &columns, &values));
  }
}

} // namespace rbvi
