// Contact with something rigid by Nitsche's method in place of multipliers (Niakh 2022, chapter 4).
#pragma once

#include "rbvi/contact/nitsche_curve.hpp"
#include "rbvi/contact/support.hpp"

namespace rbvi {

/// Below a gamma0 of some 3 the tangent is indefinite; far above the default the answer hardly
/// changes, and takes more steps. For scenes with a material. Throws bad_input for vertex
/// quadrature, and for the normal of the deformed body.
ContactRecipe by_nitsche(const RigidContact &rigid, double gamma0);

/// "rigid_support" and "rigid_surface" in files, and by Nitsche's method "nitsche_support" and
/// "nitsche_surface".
std::vector<ContactKind> rigid_kinds();

} // namespace rbvi
