// Linear complementarity with a matrix that is not symmetric: find z with
//
//   z >= 0,   w = M z + q >= 0,   z . w = 0          M: n x n
//
// Block exchange as in lcp.hpp (a semismooth Newton method); where it runs in circles, Lemke's
// method (Cottle, Pang and Stone, The Linear Complementarity Problem, 1992, section 4.4) with a
// lexicographic ratio test.
#pragma once

#include "rbvi/core/dense.hpp"

#include <string>
#include <vector>

namespace rbvi {

struct GeneralLcpResult {
  Vector z, w;               ///< n each
  std::vector<Index> active; ///< increasing
  int iterations = 0;        ///< linear systems, and pivots of Lemke's method
  bool converged = false;
  std::string reason; ///< why it stopped; not converged: what to try
};

/// Ends with a solution for P-matrices and, if there is one, for positive semidefinite matrices.
/// Violations are relative: of w to the terms of its row, of z (diagonal of M scaled to one) to its
/// largest entry. Not converged: z = 0, w = q. `start`: first guess of the active set. Throws
/// failure for sizes that do not fit or entries that are not finite.
GeneralLcpResult solve_general_lcp(const Matrix &m, const Vector &q,
                                   const std::vector<Index> &start = {});

} // namespace rbvi
