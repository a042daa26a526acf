#include "rbvi/contact/support/support.hpp"

#include "rbvi/contact/curve.hpp"

namespace rbvi {

RigidContact rigid_contact(const Support &support) {
  RigidContact rigid{support.boundary,
                     {},
                     support.friction,
                     support.lumped,
                     {"rigid_support",
                      1,
                      {{"lumped", {support.lumped ? 1.0 : 0.0}}},
                      {{"boundary", support.boundary}},
                      {{"normal", support.normal.record}, {"gap", support.gap.record}}}};
  rigid.facing.at = [normal = support.normal,
                     gap = support.gap](const FullMu &mu, const PlacedPoint &point, const Point &) {
    const Point n = normal(mu, point.x);
    return FacedPoint{n, gap(mu, point.x) - dot(point.motion, n), slip_along(n, point.motion)};
  };
  rigid.facing.normal = support.normal;
  rigid.facing.asks_place = false;
  rigid.facing.body_normal = support.body_normal;
  rigid.facing.closed_ends = {support.closed_ends, support.closed_ends};
  if (support.closed_ends) rigid.record.numbers["closed_ends"] = {1};
  if (support.body_normal) rigid.record.parts["body_normal"] = support.body_normal.record;
  add_friction(support.friction, rigid.record);
  return rigid;
}

Grid support_fields(const Scene &scene, const FullMu &mu, const ContactInterface &interface,
                    const Vector &u, const Vector &lambda) {
  const InterfaceMesh &mesh = interface.mesh();
  const std::vector<Index> &vertices = interface.dual().vertices;
  const auto count = static_cast<Index>(vertices.size());
  Grid grid = polyline(scene, mu, mesh, vertices, u);
  Vector gap(count);
  for (Index k = 0; k < count; ++k) {
    const Index node = vertices[k];
    const PointConstraint at =
        interface.constraint_at(mu, mesh.points[node], {u[2 * node], u[2 * node + 1], 0});
    gap[k] = at.gap - at.direction[0] * u[2 * node] - at.direction[1] * u[2 * node + 1];
  }
  grid.of_nodes.push_back({"gap", gap, "m"});
  grid.of_nodes.push_back({"pressure", lambda.head(count), "Pa"});
  if (lambda.size() > count)
    grid.of_nodes.push_back({"tangential_stress", lambda.tail(count), "Pa"});
  return grid;
}

ContactKind rigid_support_kind() {
  return {"rigid_support", 1, [](const Stored &of) { return rigid_support(support_in(of)); }};
}

Support support_in(const Stored &of) {
  Support support{text(of, "boundary"),
                  made<PointMap>(part(of, "normal")),
                  made<PointValue>(part(of, "gap")),
                  friction_in(of),
                  number(of, "lumped") != 0,
                  of.record.numbers.contains("closed_ends")};
  if (of.record.parts.contains("body_normal"))
    support.body_normal = made<PointMap>(part(of, "body_normal"));
  return support;
}

} // namespace rbvi
