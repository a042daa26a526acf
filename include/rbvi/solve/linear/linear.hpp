// Linear systems with A.
#pragma once

#include "rbvi/par/petsc.hpp"

namespace rbvi {

/// KSP that factorises once per operator: preonly with Cholesky by CHOLMOD on one rank, by MUMPS on
/// several; options under `prefix` override. Collective.
Handle<KSP> make_direct_solver(MPI_Comm comm, const char *prefix);

/// x = A^-1 rhs, throwing failure when KSP does not converge. Collective.
void solve_linear(KSP ksp, Vec rhs, Vec x);

} // namespace rbvi
