// Contact with friction on a reduced dual basis, the bound of friction held at collocation nodes
// alone (Niakh 2022, (3.52), (3.54)): find x = (a, b) with w = H x + q and
//
//   a >= 0,   w_n >= 0,   a . w_n = 0
//   |(T b)_j| <= s_j = c_j (N a)_j + t_j   at every collocation node j
//                                      (only in contact: t_j = 0 where (N a)_j = 0)
//   w_t . (b' - b) >= 0   for every b' that meets these bounds
//
// H = B A^-1 B^T on the reduced pair, symmetric positive definite. a: R coefficients of the cone of
// lambda_n, b: S coefficients of the modes of lambda_tau; N, T: their values at the nodes.
// Tangential multipliers of one component (2D). Niakh (2022): (3.53).
#pragma once

#include "rbvi/method/friction.hpp"
#include "rbvi/method/uzawa.hpp"

namespace rbvi {

/// The data of one problem.
struct CollocatedProblem {
  Matrix h;                            ///< (R + S) x (R + S)
  Vector q;                            ///< R + S
  Matrix normal_rows, tangential_rows; ///< N: nodes x R, entries >= 0; T: nodes x S
  std::vector<FrictionBound> bounds;   ///< of each node; a single one: of all
};

struct CollocatedResult {
  Vector x, w;         ///< R + S each
  int iterations = 0;  ///< frozen bounds, each a small QP; steps of Uzawa's method
  double residual = 0; ///< largest relative violation of the three laws
  bool converged = false;
  std::string reason; ///< not converged: what to try
};

/// Solves to round-off (1e-12): bounds frozen, the dual QP of x (NonnegativeQp: exact and
/// rank-revealing, so that more active bounds than modes do no harm), then Newton on its active
/// sets with bounds that follow the pressure; again from the better point until the laws hold.
/// Where T_E b = 0 at nodes of zero bound, b is taken from the kernel of T_E (rows and singular
/// values below 1e-13 of the largest row are zero).
/// Large c (or nodes far more than modes, with strong coupling) can have several solutions; one is
/// returned. `start`: x of a nearby problem, or empty. Throws failure for sizes that do not fit,
/// entries that are not finite, negative entries of N or an H that is not positive definite;
/// bad_input for a negative bound.
CollocatedResult solve_collocated(const CollocatedProblem &problem, const Vector &start = {});

/// The same by Uzawa's method from x = 0, corrected (3.40), (3.52), (3.55): a step for a, then for
/// b within the bounds at the new a, both projections those of the coefficients. `product`: Gram
/// matrix of the functions in W, (R + S) x (R + S). `residual` is the relative change of the last
/// step (3.19); steps along nearly dependent functions are small long before they end.
CollocatedResult solve_collocated_by_uzawa(const CollocatedProblem &problem, const Matrix &product,
                                           const UzawaOptions &options);

} // namespace rbvi
