// Displacements with which forces of reduced answers balance to round-off.
#pragma once

#include "rbvi/mor/reduce.hpp"

namespace rbvi {

/// Adds to the basis the rigid motions of bodies that contact alone holds, at the training
/// parameters, and of each body the translation along which a reaction is asked for, without the
/// nodes where displacements are imposed: answers are tested with both. Collective.
void add_balancing_functions(Problem &problem, const std::vector<Sample> &samples,
                             LinearBasis &basis);

} // namespace rbvi
