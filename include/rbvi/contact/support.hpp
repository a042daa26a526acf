// Contact of a body with something rigid along a boundary that is a polygonal curve in 2D (Niakh
// 2022, 3.2): a support, a half-plane that moves, a surface where the body now is.
//
//   (motion + w) . n <= gap,
//   and, with friction, the slip (motion + w) . tau,   tau = (-n_y, n_x).
//
// By multipliers these are continuous and linear on the edges. Displacements are those of the nodes
// of the curve, of degree 1 or 2. Everything is integrated on the mapped straight edges with four
// Gauss points, or with their two vertices, which makes the constraint one at each vertex; normal
// and gap are those at the points of the reference edges. B w <= g in the rows of the normal
// multipliers; B w - g is the slip in the others (3.12), (3.17).
// Niakh (2022): (3.7), (3.8), (3.11), (A.1), (A.2), (A.5), (A.6).
#pragma once

#include "rbvi/contact/facing.hpp"
#include "rbvi/contact/interface.hpp"

namespace rbvi {

/// What has a normal and a gap at each point, at rest.
struct Support {
  std::string boundary;
  /// Unit normal of contact at a point of the reference boundary, out of the mapped body.
  std::function<PointMap> normal;
  /// Gap along it: u . n <= gap.
  std::function<PointValue> gap;
  Friction friction{};
  bool lumped = false; ///< vertex quadrature
  /// By Nitsche's method: the unit normal of the body's exact boundary at a point of the reference
  /// boundary, out of the mapped body, which its stress acts on; empty: that of the edges.
  std::function<PointMap> body_normal{};
};

/// A half-plane whose position and tilt can be parameters. With n its unit normal, out of the body
/// and the same at all points of the boundary,
///
///   u . n <= gap = position - (x - pivot) . n,   x: on the mapped boundary or beside it (surface).
struct HalfPlane {
  std::string boundary;
  Point normal; ///< without tilt, out of the body, of length 1
  Point pivot;  ///< the plane turns about a point that lies `position` from here along the normal
  std::function<Coefficient> position;
  std::function<Coefficient> tilt{}; ///< radians, counterclockwise; empty: none
  /// The true surface of the body at a point of the reference boundary, mapped; empty: the edges.
  std::function<PointMap> surface{};
  Friction friction{};
  bool lumped = false;                   ///< vertex quadrature
  std::function<PointMap> body_normal{}; ///< Support::body_normal
};

/// A surface where the body now is: large deformations (Niakh 2022, appendix A). A point x of the
/// boundary is at y = x + motion + w. With the signed distance of the surface there and its
/// gradient nu, linearised about the state s (w = s at y),
///
///   nu . u >= nu . s - distance(y),    and, with friction, the slip (motion + u) . tau,
///
/// n = -nu, tau = (-n_y, n_x). As an inequality of weighted distances it is the first-order part of
///
///   int eta distance(x + motion + u) >= 0,
///
/// whose second derivative, -distance'' = -curvature tau tau^T, is the curvature of this interface:
/// Kacanov's iteration (A.7) is sequential quadratic programming without it. The elasticity of the
/// body stays linear. Integrals are over the undeformed curve.
struct RigidSurface {
  std::string boundary;
  std::function<Surface> surface;
  /// Where a point of the reference boundary is at rest; empty: where the map takes its edge.
  std::function<PointMap> at_rest{};
  /// The unit normal at rest, out of the mapped body. Where it is given, the condition is n . u <=
  /// n . s - distance (n . nu) with n that of the deformed body in place of -nu; it has the same
  /// limit, no curvature, and may fail from rest.
  std::function<PointMap> body_normal{};
  Friction friction{};
  bool lumped = false; ///< vertex quadrature
};

/// Of a half-plane throws bad_input for a normal whose length is not 1.
RigidContact rigid_contact(const Support &support);
RigidContact rigid_contact(const HalfPlane &plane);
RigidContact rigid_contact(const RigidSurface &surface);

/// By multipliers.
ContactRecipe by_multipliers(const RigidContact &rigid);
inline ContactRecipe rigid_support(const Support &support) {
  return by_multipliers(rigid_contact(support));
}
inline ContactRecipe half_plane(const HalfPlane &plane) {
  return by_multipliers(rigid_contact(plane));
}
inline ContactRecipe rigid_surface(const RigidSurface &surface) {
  return by_multipliers(rigid_contact(surface));
}

/// Outputs::gap_error at the vertices of a support: see ContactInterface::gap_error.
double gap_error(const ContactInterface &interface, const Scene &scene, const Facing &facing,
                 const FullMu &mu, const Vector &u, const Vector &lambda);

/// The curve of a support with motion + u, gap, pressure and tangential stress; see
/// ContactInterface::fields. `duals`: the dual node that each end of each edge of the curve has
/// there, -1: none.
Grid support_fields(const ContactInterface &interface, const Scene &scene, const Facing &facing,
                    const std::vector<std::array<Index, 2>> &duals, const FullMu &mu,
                    const Vector &u, const Vector &lambda);

} // namespace rbvi
