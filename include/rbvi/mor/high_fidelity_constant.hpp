// beta_HF and c_HF (2.3) by iterations that all ranks share.
#pragma once

#include "rbvi/par/petsc.hpp"

namespace rbvi {

/// Smallest and largest singular value of b between V and the span of all multipliers, normal and
/// tangential ones together.
struct PairConstants {
  double beta, c;
};

/// By SLEPc's EPS, prefix infsup_: beta^2 and c^2 are the smallest and the largest eigenvalue of
/// B V^-1 B^T x = lambda W x. The largest one is found with `v`, a solver of V; the smallest one as
/// that of
///   [ V  B^T ] [ u ]            [ 0  0 ] [ u ]
///   [ B  0   ] [ x ] = -lambda  [ 0  W ] [ x ]
/// nearest to zero, by inverse iteration: one factorisation of the matrix on the left by MUMPS over
/// the ranks. Without it the condition number, c^2 / beta^2, grows with each refinement. `b`:
/// multipliers x displacement dofs; `w`: their Gram matrix. Throws failure if rows of b depend on
/// each other, or if an iteration does not converge. Collective.
PairConstants iterated_constants(KSP v, Mat b, Mat w);

/// The EPS of both for so many multipliers, its options read. Throws failure for a value that SLEPc
/// refuses. Collective.
Handle<EPS> make_infsup_eps(MPI_Comm comm, PetscInt multipliers);

} // namespace rbvi
