// Hertz contact of two elastic half-disks, the lower one of parametric radius (Niakh 2022, 2.5.2).
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// Catalogue entry: name, options, maker.
SceneEntry two_disks();

} // namespace rbvi
