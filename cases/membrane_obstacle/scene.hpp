// Elastic membrane over a disc-shaped obstacle (Niakh 2022, 2.5.1).
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// Catalogue entry: name, options, maker.
SceneEntry membrane_obstacle();

/// Throws bad_input unless the disc of radius all[0] about (all[1], all[2]) is far enough from the
/// edge of the square for the ring around it not to fold.
void check_disc_in_square(const Mu &all);

} // namespace rbvi
