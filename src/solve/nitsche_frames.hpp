// Nitsche's terms in local frames.
#pragma once

#include "local_frames.hpp"
#include "rbvi/contact/nitsche/nitsche_curve.hpp"

namespace rbvi {

/// Functionals of u become those of v, u = Q v in the frames of these bounds.
void turn(const std::vector<NodalBound> &bounds, std::vector<NitscheFace> &faces);

} // namespace rbvi
