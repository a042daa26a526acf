// Hertz contact of an elastic half-disk with a rigid disk, with friction (Niakh 2022, chapter 3).
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// Catalogue entry: name, options, maker.
SceneEntry rigid_disk();

} // namespace rbvi
