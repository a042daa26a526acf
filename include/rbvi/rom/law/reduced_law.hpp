// The law of contact and friction on fewer functions than nodes, its bound at collocation nodes
// alone (MultiplierReduction::collocated). Everything in coefficients of the nodal dual basis, m of
// them: k for lambda_n, then m - k for lambda_tau, of the interfaces with friction alone.
#pragma once

#include "rbvi/law/friction/collocated_friction.hpp"
#include "rbvi/rom/body/reduced_body.hpp"
#include "rbvi/rom/law/column_laws.hpp"

namespace rbvi {

/// What the law is posed with at one mu.
struct LawAtMu {
  Vector terms;           ///< coefficient of each term of the condensed operator
  Matrix b;               ///< m x n, reduced; collocated, or with a load
  SparseMatrix b_contact; ///< m x contact dofs, where b does not separate
  const BodyAtMu *body;
  Vector q;      ///< m: the gap, and the slip, of no multipliers
  Vector load;   ///< half response to the load; empty without one
  NodeLaws laws; ///< of the m multipliers
};

/// The functions in coefficients of the nodal dual basis: m x (R + S).
Matrix multiplier_coefficients(const MultiplierBasis &basis);

/// The reduced problem; its rows are those of the collocation nodes.
CollocatedProblem collocated_problem(const MultiplierBasis &basis, const LawAtMu &law);

/// Its solution, x the coefficients of the functions. `start`: those of a nearby query, or empty:
/// from rest. Several answers are possible: `start` leads to one of them. Throws failure, saying
/// what to try, where there is none.
CollocatedResult solve_reduced_law(const MultiplierBasis &basis, const LawAtMu &law,
                                   const Vector &start = {});

/// Largest of |x - P(x - w / H_jj)| over max |x|, P the projection of the law: zero where x solves
/// it. `w` = H x + q, `diagonal`: H_jj; m entries each.
double natural_residual(const Vector &x, const Vector &w, const Vector &diagonal,
                        const NodeLaws &laws);

} // namespace rbvi
