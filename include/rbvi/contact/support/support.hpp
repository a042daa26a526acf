// Contact of a body with a rigid support along a boundary that is a polygonal curve in 2D (Niakh
// 2022, 3.2):
//
//   (motion + w) . n <= gap,      and, with friction, the slip (motion + w) . tau,   tau = (-n_y,
//   n_x).
//
// Multipliers are continuous and linear on the edges. Displacements are those of the nodes of the
// curve, of degree 1 or 2. Everything is integrated on the mapped straight edges with four Gauss
// points, or with their two vertices, which makes the constraint one at each vertex; normal and gap
// are those at the points of the reference edges. B w <= g in the rows of the normal multipliers;
// B w - g is the slip in the others (3.12), (3.17).
#pragma once

#include "rbvi/contact/facing.hpp"
#include "rbvi/contact/interface.hpp"

namespace rbvi {

struct Support {
  std::string boundary;
  /// Unit normal of contact at a point of the reference boundary, out of the mapped body.
  Named<PointMap> normal;
  /// Gap along it: u . n <= gap.
  Named<PointValue> gap;
  Friction friction{};
  bool lumped = false; ///< vertex quadrature
  /// The body ends where the boundary does: contact may reach its ends, as it may an axis of
  /// symmetry.
  bool closed_ends = false;
  /// By Nitsche's method: the unit normal of the body's exact boundary at a point of the reference
  /// boundary, out of the mapped body, which its stress acts on; empty: that of the edges.
  Named<PointMap> body_normal{};
};

RigidContact rigid_contact(const Support &support);

/// Contact with something rigid by multipliers, at rest (above) or where the body now is
/// (contact/surface).
ContactRecipe by_multipliers(const RigidContact &rigid);

inline ContactRecipe rigid_support(const Support &support) {
  return by_multipliers(rigid_contact(support));
}

/// "rigid_support" in files.
ContactKind rigid_support_kind();

/// The support of a record.
Support support_in(const Stored &of);

/// The curve of a support with motion + u, gap, pressure and tangential stress; see
/// ContactInterface::fields.
Grid support_fields(const Scene &scene, const FullMu &mu, const ContactInterface &interface,
                    const Vector &u, const Vector &lambda);

} // namespace rbvi
