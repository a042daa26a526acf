// Nitsche's terms in local frames.
#pragma once

#include "rbvi/contact/nitsche_curve.hpp"
#include "rbvi/solve/local_frames.hpp"

namespace rbvi {

/// Functionals of u become those of v, u = Q v in the frames of these bounds.
void turn(const std::vector<NodalBound> &bounds, std::vector<NitscheFace> &faces);

} // namespace rbvi
