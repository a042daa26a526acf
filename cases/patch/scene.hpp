// Patch test: a constant stress passes from one block to another.
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// Catalogue entry: name, options, maker.
SceneEntry patch();

} // namespace rbvi
