// The cases of this repository, for tests.
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// The scenes of some of cases/*/case.yaml.
const Registry &catalogue();

/// The scene of a case.
Scene make_scene(const std::string &name, const SceneOptions &options = {});

/// Each of the cases as it is, and with each choice of each of its options that needs no other.
std::vector<Scene> every_choice();
/// The same of all cases, those with meshes from files too, and each of their variants.
std::vector<Scene> every_variant();

} // namespace rbvi
