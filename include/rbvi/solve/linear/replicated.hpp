// Many right-hand sides on the contact dofs: every rank holds the whole matrix, factorises it by
// itself and solves for its share of the columns. At the sizes of a reduction on a few ranks that
// is several times faster than one factorisation spread over the ranks; its memory is that of one
// serial factorisation per rank.
#pragma once

#include "rbvi/fem/trace.hpp"

namespace rbvi {

class ReplicatedSolver {
public:
  /// Collective on the communicator of `a`, symmetric positive definite, which is marked so.
  /// Options under `prefix`; default: Cholesky by CHOLMOD. Dofs of `trace` may repeat.
  ReplicatedSolver(Mat a, const Trace &trace, const char *prefix);

  /// E^T A^-1 E loads, contact dofs x loads.cols(), on every rank; `loads` the same on all. Throws
  /// failure if A is singular or, with the default solver, not positive definite. Collective.
  Matrix responses(const Matrix &loads);
  /// A^-1 E loads as a dense distributed matrix with the row layout of `a`. Collective.
  Handle<Mat> fields(const Matrix &loads);
  /// E^T of such fields, on every rank. Collective.
  Matrix restrict(Mat fields) const { return restrict_to(trace_, fields); }

private:
  Matrix solve_columns(const Matrix &loads, Index first, Index count);
  void exchange_rows(const Matrix &mine, Index columns, double *values, Index stride) const;

  MPI_Comm comm_;
  Trace trace_;
  PetscInt local_rows_ = 0;
  std::vector<PetscInt> first_rows_; ///< of each rank, and behind the last
  Handle<Mat> whole_;                ///< all of A, on this rank
  Handle<KSP> ksp_;
  std::vector<PetscInt> rows_; ///< of each contact dof in `whole_`
};

} // namespace rbvi
