// The extremes of a box of parameters.
#pragma once

#include "rbvi/core/parameters.hpp"

namespace rbvi {

/// The corners of the box, 32 of them where there are more, and the centres of its faces (of one
/// parameter its ends): where random sets never are, and where models are worst.
std::vector<Mu> extremes_of_box(const ParameterSpace &space);

} // namespace rbvi
