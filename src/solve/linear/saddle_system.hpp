// The system of an active set with its multipliers in one matrix, where they cannot be eliminated:
//
//   A u + W^T y = f,      C u = c,
//
// by a sparse LU factorisation (MUMPS) that the ranks share.
#pragma once

#include "rbvi/fem/trace.hpp"

namespace rbvi {

/// Sets u and returns y, on every rank. `w`, `c`: constraints x contact dofs, the same on every
/// rank. Throws failure, saying what to try, where the matrix is singular or what is found does not
/// meet the system to 1e-9. Options under hf_saddle_. Collective.
Vector solve_saddle(const Trace &trace, Mat a, const SparseMatrix &w, const SparseMatrix &c, Vec f,
                    const Vector &right, Vec u);

} // namespace rbvi
