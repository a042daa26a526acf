// Units of outputs, where the scene declares some.
#pragma once

#include "rbvi/core/outputs.hpp"
#include "rbvi/core/scene.hpp"

namespace rbvi {

/// Plane bodies are those of a unit of thickness.
Dimension size_of(const Scene &scene, Size size);

/// "" without units, or where it is not known.
std::string unit_of(const Scene &scene, const OutputColumn &column);

/// What it is: of a named output what its case says.
std::string says_of(const Scene &scene, const OutputColumn &column);

} // namespace rbvi
