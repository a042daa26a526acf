// Contact with a rigid support by Nitsche's method in place of multipliers (Niakh 2022, chapter 4).
#pragma once

#include "rbvi/contact/nitsche/nitsche_curve.hpp"

namespace rbvi {

/// Below a gamma0 of some 3 the tangent is indefinite; far above the default the answer hardly
/// changes, and takes more steps. For scenes with a material.
ContactRecipe nitsche_support(Support support, double gamma0);

/// "nitsche_support" in files.
ContactKind nitsche_support_kind();

/// The options `formulation` and `nitsche_gamma0` of scenes with a support.
std::vector<SceneOption> nitsche_options();
bool asks_for_nitsche(const SceneOptions &options);

/// This support by multipliers or by Nitsche's method, as these options say.
ContactRecipe support_contact(Support support, const SceneOptions &options);

} // namespace rbvi
