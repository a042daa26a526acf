// The law of contact and friction on fewer functions, of a reduced body at one mu.
#pragma once

#include "rbvi/method/published/collocated_friction.hpp"
#include "rbvi/model/law_problem.hpp"

namespace rbvi {

/// The reduced problem; its rows are those of the collocation nodes.
CollocatedProblem collocated_problem(const MultiplierBasis &basis, const LawAtMu &law,
                                     const BodyAtMu &body);

} // namespace rbvi
