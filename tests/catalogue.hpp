// The cases of this repository, for tests.
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// What the library knows, and the scenes of cases/*/case.yaml.
const Registry &catalogue();

/// The scene of a case.
Scene make_scene(const std::string &name, const SceneOptions &options = {});

} // namespace rbvi
