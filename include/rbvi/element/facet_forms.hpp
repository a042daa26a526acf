// Kernels over the facets of a boundary, as Forms: tractions, pressures, springs, of degree 1 or 2,
// over edges of triangles and faces of tetrahedra alike; local dof = node * components + component.
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// int t . v, exact where t is of degree 3 (axisymmetric: 2). Throws bad_input for a degree other
/// than 1 and 2.
Form traction_load(const std::string &boundary, const std::function<Traction> &traction,
                   int components, int degree, bool axisymmetric = false);

/// - int value n . v: a pressure pushes. Throws likewise.
Form pressure_load(const std::string &boundary, double value, int components, int degree);

/// stiffness * int u . v: springs of so much per length or area, in every direction. Throws
/// likewise.
Form spring(const std::string &boundary, double stiffness, int components, int degree);

} // namespace rbvi
