#include "rbvi/contact/surface/surface.hpp"

namespace rbvi {

RigidContact rigid_contact(const RigidSurface &surface) {
  RigidContact rigid{surface.boundary,
                     {},
                     surface.friction,
                     surface.lumped,
                     {"rigid_surface",
                      1,
                      {{"lumped", {surface.lumped ? 1.0 : 0.0}}},
                      {{"boundary", surface.boundary}},
                      {{"surface", surface.surface.record}}}};
  rigid.facing.at = [faced = surface.surface](const FullMu &mu, const PlacedPoint &point,
                                              const Point &displacement) {
    const SurfacePoint below =
        faced(mu, {point.y[0] + displacement[0], point.y[1] + displacement[1], point.y[2]});
    const Point n{-below.normal[0], -below.normal[1], 0};
    return FacedPoint{n, below.distance + dot(n, displacement), slip_along(n, point.motion),
                      below.curvature};
  };
  rigid.facing.at_rest = surface.at_rest;
  rigid.facing.follows_state = true;
  rigid.facing.body_normal = surface.body_normal;
  rigid.facing.along_body = bool(surface.body_normal);
  if (surface.at_rest) rigid.record.parts["at_rest"] = surface.at_rest.record;
  if (surface.body_normal) rigid.record.parts["body_normal"] = surface.body_normal.record;
  add_friction(surface.friction, rigid.record);
  return rigid;
}

RigidSurface surface_in(const Stored &of) {
  RigidSurface surface{text(of, "boundary"), made<Surface>(part(of, "surface"))};
  if (of.record.parts.contains("at_rest")) surface.at_rest = made<PointMap>(part(of, "at_rest"));
  if (of.record.parts.contains("body_normal"))
    surface.body_normal = made<PointMap>(part(of, "body_normal"));
  surface.friction = friction_in(of);
  surface.lumped = number(of, "lumped") != 0;
  return surface;
}

ContactKind rigid_surface_kind() {
  return {"rigid_surface", 1, [](const Stored &of) { return rigid_surface(surface_in(of)); }};
}

} // namespace rbvi
