// Contact of a body with a rigid surface where the body now is: large deformations (Niakh 2022,
// appendix A). A point x of the boundary is at y = x + motion + w. With the signed distance of the
// surface there and its gradient nu, linearised about the state s (w = s at y),
//
//   nu . u >= nu . s - distance(y),    and, with friction, the slip (motion + u) . tau,
//
// n = -nu, tau = (-n_y, n_x). As an inequality of weighted distances it is the first-order part of
//
//   int eta distance(x + motion + u) >= 0,
//
// whose second derivative, -distance'' = -curvature tau tau^T, is the curvature of this interface:
// Kacanov's iteration (A.7) is sequential quadratic programming without it. The elasticity of the
// body stays linear. Integrals are those of a support (contact/support), over the undeformed curve.
#pragma once

#include "rbvi/contact/support/support.hpp"

namespace rbvi {

struct RigidSurface {
  std::string boundary;
  Named<Surface> surface;
  /// Where a point of the reference boundary is at rest; empty: where the map takes its edge.
  Named<PointMap> at_rest{};
  /// The unit normal at rest, out of the mapped body. Where it is given, the condition is n . u <=
  /// n . s - distance (n . nu) with n that of the deformed body in place of -nu; it has the same
  /// limit, no curvature, and may fail from rest.
  Named<PointMap> body_normal{};
  Friction friction{};
  bool lumped = false; ///< vertex quadrature
};

RigidContact rigid_contact(const RigidSurface &surface);

inline ContactRecipe rigid_surface(const RigidSurface &surface) {
  return by_multipliers(rigid_contact(surface));
}

/// The surface of a record.
RigidSurface surface_in(const Stored &of);

/// "rigid_surface" in files.
ContactKind rigid_surface_kind();

} // namespace rbvi
