// Elastic membrane over a disc-shaped obstacle (Niakh 2022, 2.5.1).
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// Catalogue entry: name, options, maker.
SceneEntry membrane_obstacle();

} // namespace rbvi
