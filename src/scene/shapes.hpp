// Meshes that are built in, by the names of their shapes. They know no scene.
#pragma once

#include "rbvi/contact/surfaces.hpp"
#include "rbvi/core/scene.hpp"

namespace rbvi {

struct Shape {
  MeshRecipe recipe;
  /// Circles that its boundaries, or the rims of its regions, lie on.
  std::map<std::string, std::vector<Circle>> circles{};
};

/// What one can choose of them, beside the shape itself.
struct ShapeNumbers {
  int edges = 0;       ///< of the contact boundary; 0: the default of the shape
  double angle = 22.5; ///< half_disc: half of the contact arc, in degrees: 22.5 or 45
};

const std::vector<std::string> &shape_names();

/// Throws bad_input for an unknown shape, or for numbers that it cannot have.
Shape shape_of(const std::string &name, const ShapeNumbers &numbers);

} // namespace rbvi
