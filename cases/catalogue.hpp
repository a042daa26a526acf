// The scenes of these folders, as the programs of src/bin know them.
#pragma once

#include "rbvi/contact/registry.hpp"

namespace rbvi {

const Registry &catalogue();

/// One of them; throws as entry_of and make_scene.
Scene make_scene(const std::string &name, const SceneOptions &options = {});

} // namespace rbvi
