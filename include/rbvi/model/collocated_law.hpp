// The law of contact and friction on fewer functions than nodes, its bound at collocation nodes
// alone (MultiplierReduction::collocated). Everything in coefficients of the nodal dual basis, m of
// them: k for lambda_n, then m - k for lambda_tau, of the interfaces with friction alone.
#pragma once

#include "rbvi/method/collocated_friction.hpp"
#include "rbvi/model/law_problem.hpp"

namespace rbvi {

/// The functions in coefficients of the nodal dual basis: m x (R + S).
Matrix multiplier_coefficients(const MultiplierBasis &basis);

/// The reduced problem; its rows are those of the collocation nodes.
CollocatedProblem collocated_problem(const MultiplierBasis &basis, const LawAtMu &law,
                                     const BodyAtMu &body);

} // namespace rbvi
