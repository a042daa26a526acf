// What a program knows by name: what the library has, and scenes of its own.
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// Scenes that are code, with their functions, beside the kinds of contact and the functions of the
/// library.
Registry registry_of(std::vector<SceneEntry> scenes);

/// The contact of a record. Throws bad_input for a kind that the registry does not have, or has in
/// another version.
ContactRecipe contact_in(const Stored &stored);

} // namespace rbvi
