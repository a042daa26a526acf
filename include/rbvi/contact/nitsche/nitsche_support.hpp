// Contact with a rigid support by Nitsche's method in place of multipliers (Niakh 2022, chapter 4).
#pragma once

#include "rbvi/contact/half_plane/half_plane.hpp"
#include "rbvi/contact/nitsche/nitsche_curve.hpp"
#include "rbvi/contact/surface/surface.hpp"

namespace rbvi {

/// Below a gamma0 of some 3 the tangent is indefinite; far above the default the answer hardly
/// changes, and takes more steps. For scenes with a material. Throws bad_input for vertex
/// quadrature.
ContactRecipe nitsche_support(Support support, double gamma0);

/// A support that is a half-plane.
ContactRecipe nitsche_half_plane(HalfPlane plane, double gamma0);

/// With a rigid surface where the body now is (large deformations). Throws bad_input for the normal
/// of the deformed body and for vertex quadrature.
ContactRecipe nitsche_surface(RigidSurface surface, double gamma0);

/// "nitsche_support", "nitsche_half_plane", "nitsche_surface" in files.
ContactKind nitsche_support_kind();
ContactKind nitsche_half_plane_kind();
ContactKind nitsche_surface_kind();

/// What these are as a curve of Nitsche's method faces them. `scene` outlives it.
NitscheFacing facing_support(const Scene &scene, Support support);
NitscheFacing facing_surface(const Scene &scene, RigidSurface surface);

/// The options `formulation` and `nitsche_gamma0` of scenes with a support.
std::vector<SceneOption> nitsche_options();
bool asks_for_nitsche(const SceneOptions &options);

/// This support, half-plane or surface, by multipliers or by Nitsche's method, as these options
/// say.
ContactRecipe support_contact(Support support, const SceneOptions &options);
ContactRecipe half_plane_contact(HalfPlane plane, const SceneOptions &options);
ContactRecipe surface_contact(RigidSurface surface, const SceneOptions &options);

} // namespace rbvi
