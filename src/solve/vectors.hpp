// Small things that solvers ask of distributed vectors. Collective.
#pragma once

#include "rbvi/par/petsc.hpp"

namespace rbvi {

inline double norm(Vec v) {
  PetscReal value = 0;
  RBVI_CALL(VecNorm(v, NORM_2, &value));
  return value;
}

inline double dot(Vec a, Vec b) {
  PetscScalar value = 0;
  RBVI_CALL(VecDot(a, b, &value));
  return value;
}

/// A vector of the same layout; its values are not set.
inline Handle<Vec> like(Vec v) {
  Handle<Vec> result;
  RBVI_CALL(VecDuplicate(v, result.put()));
  return result;
}

} // namespace rbvi
