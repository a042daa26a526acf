// Which of the two ways to solve contact by active sets takes less: an estimate from sizes, in
// units of one solve with the factors of A.
#pragma once

#include "rbvi/solve/high_fidelity.hpp"

#include <string>

namespace rbvi {

/// Of one sample on average, in solves with A.
struct ContactCost {
  double condensed = 0;  ///< columns of B A^-1 B^T, and dense systems of the active ones
  double eliminated = 0; ///< a factorisation, and Krylov steps
};

/// `samples`: that share what can be kept.
ContactCost contact_cost(const Problem &problem, int samples);

/// Whether the columns of a compliance that is kept, so many of them, are made by A's Schur
/// complement (solve/complement.hpp): by sizes, and where options leave A a direct solver.
bool takes_complement(const Problem &problem, double columns);

/// What HighFidelity does with these options: by the estimate unless they say. Where contact
/// follows the displacement, where there are few dofs, or where a part of A is scaled and there are
/// several samples, it is condensed.
bool eliminates(const Problem &problem, const HfOptions &options);

/// In one line.
std::string contact_cost_text(const Problem &problem, const HfOptions &options);

} // namespace rbvi
