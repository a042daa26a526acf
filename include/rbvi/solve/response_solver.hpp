// Many right-hand sides on the contact dofs. Where the factors of all ranks fit into the memory of
// their node, every rank holds the whole matrix, factorises it by itself and solves for its share
// of the columns: at the sizes of a reduction on a few ranks that is several times faster than one
// factorisation spread over them. Where they do not fit, the ranks share one.
#pragma once

#include "rbvi/fem/trace.hpp"

namespace rbvi {

enum class Factors {
  automatic, ///< whole where they fit (factors_fit)
  whole,     ///< one on every rank
  shared     ///< one, spread over the ranks
};

/// Peak of the memory in bytes that a solve with so many dofs takes in two dimensions, on one rank,
/// with a factorisation. Measured, rather too much than too little.
double plane_solve_bytes(double dofs);

/// Whether one such factor for every rank leaves half of the memory of each node free. Collective.
bool factors_fit(MPI_Comm comm, PetscInt dofs);

class ResponseSolver {
public:
  /// Collective on the communicator of `a`, symmetric positive definite, which is marked so.
  /// Options under `prefix`; default: Cholesky by CHOLMOD, shared by MUMPS. Dofs of `trace` may
  /// repeat.
  ResponseSolver(Mat a, const Trace &trace, const char *prefix,
                 Factors factors = Factors::automatic);

  /// Another A with the nonzero pattern of the first: what it was ordered by is kept. Collective.
  void set(Mat a);

  /// E^T A^-1 E loads, contact dofs x loads.cols(), on every rank; `loads` the same on all. Throws
  /// failure if A is singular or, with the default solver, not positive definite. Collective.
  Matrix responses(const Matrix &loads);
  /// A^-1 E loads as a dense distributed matrix with the row layout of `a`. Collective.
  Handle<Mat> fields(const Matrix &loads);
  /// E^T of such fields, on every rank. Collective.
  Matrix restrict(Mat fields) const { return restrict_to(trace_, fields); }

private:
  void solve(Mat right, Mat solution);
  Matrix solve_columns(const Matrix &loads, Index first, Index count);
  void solve_shared(const Matrix &loads, Mat solution);
  void exchange_rows(const Matrix &mine, Index columns, double *values, Index stride) const;
  Handle<Mat> dense_fields(Index columns) const;

  MPI_Comm comm_;
  Trace trace_;
  bool shared_;
  PetscInt local_rows_ = 0;
  std::vector<PetscInt> first_rows_; ///< of each rank, and behind the last
  Handle<Mat> a_;                    ///< on this rank all of it, or shared
  Handle<KSP> ksp_;
  std::vector<PetscInt> rows_; ///< of each contact dof in `a_`, where that is whole
};

} // namespace rbvi
