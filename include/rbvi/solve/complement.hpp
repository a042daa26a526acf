// The compliance E^T A^-1 E of a body on few of its dofs, without a solve for each of them: it is
// the inverse of A's Schur complement there, which a factorisation that takes these dofs last
// leaves. On the boundary of a plane body that is some ten times faster than solving.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/fem/trace.hpp"
#include "rbvi/solve/response_solver.hpp"

namespace rbvi {

/// What a complement on `size` of the dofs of A and its inverse take, in single solves with the
/// factors of A.
double complement_cost(PetscInt dofs, PetscInt size);

/// Whether the complement on `size` dofs takes less than so many solves with factors of A that are
/// there (`factored`) or would have to be made. `dofs`: of A.
bool complement_pays(PetscInt dofs, PetscInt size, double solves, bool factored);

/// Whether options under `prefix` leave the solver of A a direct one, in place of which a
/// complement can be. Not collective.
bool solves_directly(const char *prefix);

/// E^T A^-1 E, symmetric, on every rank; no dof of `trace` may repeat. The first rank factorises
/// all of A. Throws failure where A is not positive definite. Collective.
Matrix compliance_by_complement(Mat a, const Trace &trace);

/// loads^T E^T A^-1 E loads, symmetric, on every rank: by the complement on the dofs that the loads
/// touch where that pays, else by solves: by `solver`, or one made with options under `prefix`.
/// `loads`: dofs of `trace`, which may repeat, x any number. Throws failure where A is not positive
/// definite. Collective.
Matrix condensed_by_loads(Mat a, const Trace &trace, const char *prefix, const Matrix &loads,
                          ResponseSolver *solver = nullptr);

} // namespace rbvi
