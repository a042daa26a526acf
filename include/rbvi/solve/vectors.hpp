// Small things that solvers ask of distributed vectors. Collective, but LocalValues.
#pragma once

#include "rbvi/core/dense.hpp"
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

/// This rank's entries, to read and to write while it lives.
class LocalValues {
public:
  explicit LocalValues(Vec v) : v_(v) {
    PetscInt size = 0;
    RBVI_CALL(VecGetLocalSize(v, &size));
    RBVI_CALL(VecGetArray(v, &raw_));
    new (&values_) Eigen::Map<Vector>(raw_, size);
  }
  ~LocalValues() { (void)VecRestoreArray(v_, &raw_); }
  LocalValues(const LocalValues &) = delete;
  LocalValues &operator=(const LocalValues &) = delete;
  Eigen::Map<Vector> &get() { return values_; }
  const Eigen::Map<Vector> &get() const { return values_; }

private:
  Vec v_;
  PetscScalar *raw_ = nullptr;
  Eigen::Map<Vector> values_{nullptr, 0};
};

} // namespace rbvi
