// Contact of a body with something rigid along a boundary that is a polygonal curve in 2D (Niakh
// 2022, 3.2): a support, of which normal and gap are functions, or a surface, at rest or where the
// body now is.
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
#include "rbvi/contact/surfaces.hpp"

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

/// A rigid surface. With the signed distance of the surface and its gradient nu, a point at y at
/// rest, which moves by the motion of the scene and by u, has at rest (small kinematics) the
/// condition
///
///   n . (motion + u) <= n . (partner(y) - y),   n = -nu(y), or the normal of the body.
///
/// Where the body now is (large deformations; Niakh 2022, appendix A), linearised about the state
/// s, n = -nu(y + motion + s),
///
///   n . u <= n . s + distance(y + motion + s),
///
/// and in both, with friction, the slip (motion + u) . tau, tau = (-n_y, n_x). As an inequality of
/// weighted distances the second is the first-order part of
///
///   int eta distance(y + motion + u) >= 0,
///
/// whose second derivative, -distance'' = -curvature tau tau^T, is the curvature of this interface:
/// Kacanov's iteration (A.7) is sequential quadratic programming without it. The elasticity of the
/// body stays linear. Integrals are over the undeformed curve.
struct RigidSurface {
  std::string boundary;
  std::function<Surface> surface; ///< contact/surfaces.hpp
  /// Where a point of the reference boundary is at rest; empty: where the map takes its edge.
  std::function<PointMap> at_rest{};
  /// The unit normal of the body's exact boundary at rest, at a point of the reference boundary,
  /// out of the mapped body: by Nitsche's method its stress acts on it; empty: that of the edges.
  std::function<PointMap> body_normal{};
  /// n is that of the body in place of -nu. Where the body now is, it is that of the deformed body:
  /// n . u <= n . s - distance (n . nu) has the same limit, no curvature, and may fail from rest.
  bool along_body = false;
  Partner partner = Partner::closest;
  bool large = false; ///< the condition holds where the body now is
  Friction friction{};
  bool lumped = false; ///< vertex quadrature
};

/// Of a surface throws bad_input for what does not go together: `along_body` without the body's
/// normal, and another partner than the closest point where the body now is.
RigidContact rigid_contact(const Support &support);
RigidContact rigid_contact(const RigidSurface &surface);

/// By multipliers.
ContactRecipe by_multipliers(const RigidContact &rigid);
inline ContactRecipe rigid_support(const Support &support) {
  return by_multipliers(rigid_contact(support));
}
inline ContactRecipe rigid_surface(const RigidSurface &surface) {
  return by_multipliers(rigid_contact(surface));
}

/// Outputs::gap_error at the vertices of a support: see ContactInterface::gap_error.
double gap_error(const ContactInterface &interface, const Scene &scene, const Facing &facing,
                 const FullMu &mu, const Vector &u, const Vector &lambda);

/// The curve of a support with motion + u, gap, pressure and tangential stress; see
/// ContactInterface::fields. `duals`: the dual node that each end of each edge of the curve has
/// there, -1: none. `whole`: as in fields.
Grid support_fields(const ContactInterface &interface, const Scene &scene, const Facing &facing,
                    const std::vector<std::array<Index, 2>> &duals, const FullMu &mu,
                    const Vector &u, const Vector &lambda, bool whole);

} // namespace rbvi
