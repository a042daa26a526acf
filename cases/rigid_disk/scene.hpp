// Hertz contact of an elastic half-disk with a rigid disk, with friction (Niakh 2022, chapter 3).
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// Catalogue entry: name, options, maker.
SceneEntry rigid_disk();

/// Throws bad_input unless the indentation all[1] is small enough beside the radius all[0] for
/// contact to stay on the arc.
void check_indentation(const Mu &all);

} // namespace rbvi
