#include "rbvi/par/small_eigen.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/par/small_svd.hpp"

namespace rbvi {

SmallEigen::SmallEigen(const char *prefix) : prefix_(prefix) {
  constexpr PetscInt divide_and_conquer = 2; // DSHEP; the fastest of its methods with vectors
  RBVI_CALL(EPSCreate(PETSC_COMM_SELF, eps_.put()));
  RBVI_CALL(EPSSetOptionsPrefix(eps_.get(), prefix));
  RBVI_CALL(EPSSetProblemType(eps_.get(), EPS_HEP));
  RBVI_CALL(EPSSetType(eps_.get(), EPSLAPACK));
  RBVI_CALL(EPSSetFromOptions(eps_.get()));
  RBVI_CALL(EPSSetWhichEigenpairs(eps_.get(), EPS_LARGEST_REAL));
  PetscBool dense = PETSC_FALSE;
  RBVI_CALL(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(eps_.get()), EPSLAPACK, &dense));
  if (dense == PETSC_FALSE) return;
  DS ds = nullptr;
  RBVI_CALL(EPSGetDS(eps_.get(), &ds));
  RBVI_CALL(DSSetMethod(ds, divide_and_conquer));
}

Vector SmallEigen::values(const Matrix &matrix) {
  size_ = matrix.rows();
  Vector values(size_);
  if (size_ == 0) return values;
  if (!matrix.allFinite()) throw failure("eigenvalues of a matrix with entries not finite");
  const auto wanted = static_cast<PetscInt>(size_);
  const Handle<Mat> copy = sequential_dense(matrix.selfadjointView<Eigen::Lower>());
  RBVI_CALL(EPSSetOperators(eps_.get(), copy.get(), nullptr));
  RBVI_CALL(EPSSetDimensions(eps_.get(), wanted, PETSC_DEFAULT, PETSC_DEFAULT));
  RBVI_CALL(EPSSolve(eps_.get()));
  PetscInt converged = 0;
  RBVI_CALL(EPSGetConverged(eps_.get(), &converged));
  if (converged < wanted)
    throw failure("SLEPc returned " + std::to_string(converged) + " of " + std::to_string(wanted) +
                  " eigenvalues of a dense matrix: leave out -" + prefix_ + "eps_type");
  for (Index k = 0; k < size_; ++k)
    RBVI_CALL(EPSGetEigenvalue(eps_.get(), static_cast<PetscInt>(k), &values(k), nullptr));
  return values;
}

Matrix SmallEigen::vectors(Index count) const {
  Matrix result(size_, count);
  Handle<Vec> column;
  for (Index k = 0; k < count; ++k) {
    RBVI_CALL(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, static_cast<PetscInt>(size_),
                                    result.col(k).data(), column.put()));
    RBVI_CALL(EPSGetEigenvector(eps_.get(), static_cast<PetscInt>(k), column.get(), nullptr));
  }
  return result;
}

} // namespace rbvi
