// A roller on a hub between two plates, one of them with friction: two contact interfaces.
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// Catalogue entry: name, options, maker.
SceneEntry roller();

} // namespace rbvi
