// Linear systems with A.
#pragma once

#include "rbvi/par/petsc.hpp"

namespace rbvi {

/// KSP that factorises once per operator: preonly with Cholesky by CHOLMOD on one rank, by MUMPS on
/// several; options under `prefix` override. Collective.
Handle<KSP> make_direct_solver(MPI_Comm comm, const char *prefix);

/// KSP that applies one cycle of algebraic multigrid (GAMG), or once the preconditioner that an
/// option under `prefix` names, for a method around it. Collective.
Handle<KSP> make_multigrid(MPI_Comm comm, const char *prefix);

/// What MUMPS orders its factors by. By minimum fill factors of plane problems are a third larger,
/// and are there before other orderings are through: for few solves.
enum class Ordering { automatic, minimum_fill };

/// The matrix that a solver of the first kind has next, symmetric positive definite. MUMPS gets
/// more room than it takes by itself: what it needs depends on how its ranks happen to share the
/// work. Collective.
void set_operator(KSP ksp, Mat a, Ordering ordering = Ordering::automatic);

/// x = A^-1 rhs, throwing failure when KSP does not converge. Collective.
void solve_linear(KSP ksp, Vec rhs, Vec x);
/// The same refined, where the residual is not of round-off: at most twice. Returns how far x may
/// be off where round-off of A u leaves more, |last correction| / |x|; else 0. Collective.
double solve_refined(KSP ksp, Vec rhs, Vec x);

} // namespace rbvi
