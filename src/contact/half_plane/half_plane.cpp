#include "rbvi/contact/half_plane/half_plane.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <cmath>

namespace rbvi {

namespace {

Point normal_of(const HalfPlane &plane, const FullMu &mu) {
  const double angle = plane.tilt ? plane.tilt(mu) : 0;
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * plane.normal[0] - s * plane.normal[1], s * plane.normal[0] + c * plane.normal[1], 0};
}

Record record_of(const HalfPlane &plane) {
  const auto coordinates = [](const Point &x) { return std::vector<double>(x.begin(), x.end()); };
  Record record{"half_plane",
                1,
                {{"normal", coordinates(plane.normal)},
                 {"pivot", coordinates(plane.pivot)},
                 {"lumped", {plane.lumped ? 1.0 : 0.0}}},
                {{"boundary", plane.boundary}},
                {{"position", plane.position.record}}};
  if (plane.tilt) record.parts["tilt"] = plane.tilt.record;
  if (plane.surface) record.parts["surface"] = plane.surface.record;
  if (plane.body_normal) record.parts["body_normal"] = plane.body_normal.record;
  add_friction(plane.friction, record);
  return record;
}

} // namespace

HalfPlane half_plane_in(const Stored &of) {
  const auto point = [&](const std::string &name) -> Point {
    const std::vector<double> &x = numbers(of, name);
    if (x.size() != 3) throw bad_input("'" + name + "' of a half-plane is not three numbers");
    return {x[0], x[1], x[2]};
  };
  HalfPlane plane{text(of, "boundary"), point("normal"), point("pivot"),
                  made<Coefficient>(part(of, "position"))};
  if (of.record.parts.contains("tilt")) plane.tilt = made<Coefficient>(part(of, "tilt"));
  if (of.record.parts.contains("surface")) plane.surface = made<PointMap>(part(of, "surface"));
  plane.friction = friction_in(of);
  plane.lumped = number(of, "lumped") != 0;
  if (of.record.parts.contains("body_normal"))
    plane.body_normal = made<PointMap>(part(of, "body_normal"));
  return plane;
}

RigidContact rigid_contact(const HalfPlane &plane) {
  const double length = std::hypot(plane.normal[0], plane.normal[1], plane.normal[2]);
  if (!(std::abs(length - 1) <= 1e-12) || plane.normal[2] != 0)
    throw bad_input("the normal of the half-plane on '" + plane.boundary + "' is (" +
                    short_number(plane.normal[0]) + ", " + short_number(plane.normal[1]) + ", " +
                    short_number(plane.normal[2]) +
                    "): give one of length 1 in the plane of x and y");
  RigidContact rigid{plane.boundary, {}, plane.friction, plane.lumped, record_of(plane)};
  rigid.facing.at = [plane](const FullMu &mu, const PlacedPoint &point, const Point &) {
    const Point n = normal_of(plane, mu);
    const double gap = plane.position(mu) - (point.y[0] - plane.pivot[0]) * n[0] -
                       (point.y[1] - plane.pivot[1]) * n[1];
    return FacedPoint{n, gap, slip_along(n, point.motion)};
  };
  rigid.facing.normal = [plane](const FullMu &mu, const Point &) { return normal_of(plane, mu); };
  rigid.facing.at_rest = plane.surface;
  rigid.facing.body_normal = plane.body_normal;
  rigid.coefficients.push_back({"position of the half-plane", plane.position});
  if (plane.tilt) rigid.coefficients.push_back({"tilt of the half-plane", plane.tilt});
  return rigid;
}

ContactKind half_plane_kind() {
  return {"half_plane", 1, [](const Stored &of) { return half_plane(half_plane_in(of)); }};
}

} // namespace rbvi
