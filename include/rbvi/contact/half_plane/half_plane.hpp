// Contact with a rigid half-plane that moves: its position and its tilt can be parameters. With n
// the unit normal of the plane, out of the body and the same at all points of the boundary,
//
//   u . n <= gap = position - (x - pivot) . n,   x: on the mapped boundary or beside it (surface),
//
// and friction against u . tau as on any rigid support (Niakh 2022, 3.2), whose kernels these are.
#pragma once

#include "rbvi/contact/support/support.hpp"

namespace rbvi {

struct HalfPlane {
  std::string boundary;
  Point normal; ///< without tilt, out of the body, of length 1
  Point pivot;  ///< the plane turns about a point that lies `position` from here along the normal
  Named<Coefficient> position;
  Named<Coefficient> tilt{}; ///< radians, counterclockwise; empty: none
  /// The true surface of the body at a point of the reference boundary, mapped; empty: the edges.
  Named<PointMap> surface{};
  Friction friction{};
  bool lumped = false;           ///< vertex quadrature
  Named<PointMap> body_normal{}; ///< Support::body_normal
};

/// Throws bad_input for a normal whose length is not 1.
RigidContact rigid_contact(const HalfPlane &plane);

inline ContactRecipe half_plane(const HalfPlane &plane) {
  return by_multipliers(rigid_contact(plane));
}

/// The half-plane of a record.
HalfPlane half_plane_in(const Stored &of);

/// "half_plane" in files.
ContactKind half_plane_kind();

} // namespace rbvi
