// The system of an active set with its multipliers in one matrix, where they cannot be eliminated:
//
//   A u + W^T y = f,      C u = c,
//
// by a sparse LU factorisation (MUMPS) that the ranks share.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/par/petsc.hpp"

namespace rbvi {

/// Sets u and returns this rank's y. `w`, `c`: constraints x free displacement dofs; `right`: c of
/// this rank's constraints. Throws failure, saying what to try, where the matrix is singular or
/// what is found does not meet the system to 1e-9. Options under hf_saddle_. Collective.
Vector solve_saddle(Mat a, Mat w, Mat c, Vec f, const Vector &right, Vec u);

} // namespace rbvi
