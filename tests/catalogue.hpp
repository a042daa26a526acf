// The cases of this repository, for tests.
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// What the library knows, and the scenes of cases/*/case.yaml.
const Registry &catalogue();

/// The scene of a case.
Scene make_scene(const std::string &name, const SceneOptions &options = {});

/// Each of the cases as it is, and with each choice of each of its options that needs no other.
std::vector<Scene> every_choice();

} // namespace rbvi
