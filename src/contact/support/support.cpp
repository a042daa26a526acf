#include "rbvi/contact/support/support.hpp"

#include "rbvi/contact/curve.hpp"
#include "rbvi/contact/support/curve_support.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

namespace rbvi {

namespace {

class SupportInterface : public CurveSupport {
public:
  SupportInterface(const Scene &scene, InterfaceMesh interface_mesh, Support support)
      : CurveSupport(scene, std::move(interface_mesh), support.friction, support.lumped),
        support_(std::move(support)) {
    find_side();
  }

  PointConstraint constraint_at(const FullMu &mu, const Point &x, const Point &,
                                const Point &) const override {
    const SupportPoint at = support_point(scene_, support_, mu, x);
    return {at.normal, at.gap};
  }

protected:
  SupportPoint support_at(const FullMu &mu, const Cell &, const TracePoint &,
                          const Point &x) const override {
    return support_point(scene_, support_, mu, x);
  }
  Point normal_at(const FullMu &mu, const Cell &, const TracePoint &,
                  const Point &x) const override {
    return support_.normal(mu, x);
  }
  bool counts_ends() const override { return !support_.closed_ends; }

private:
  Support support_;
};

} // namespace

SupportPoint support_point(const Scene &scene, const Support &support, const FullMu &mu,
                           const Point &x) {
  const Point n = support.normal(mu, x);
  SupportPoint point{n, support.gap(mu, x), 0};
  if (scene.motion) {
    const Point motion = scene.motion(mu, x);
    point.gap -= motion[0] * n[0] + motion[1] * n[1];
    point.slip = motion[1] * n[0] - motion[0] * n[1];
  }
  return point;
}

void check_pressed_side(double cosine, const Point &x) {
  if (!(cosine > 0))
    throw failure(
        "contact through the body: it is pressed at (" + short_number(x[0]) + ", " +
        short_number(x[1]) +
        ") of its boundary from inside, as what it faces there lies behind it; move less, "
        "or pose contact on a shorter boundary");
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

ContactRecipe rigid_support(Support support) {
  ContactRecipe recipe;
  recipe.entities = {InterfaceEntities::Kind::curves, {support.boundary}};
  add_friction(support.friction, recipe);
  recipe.nodal = support.lumped;
  recipe.keeps_nodes = true;
  recipe.make = [support](const Scene &scene, InterfaceMesh mesh) {
    return std::make_unique<SupportInterface>(scene, std::move(mesh), support);
  };
  recipe.record = record_of(support);
  return recipe;
}

ContactKind rigid_support_kind() {
  return {"rigid_support", 1, [](const Stored &of) { return rigid_support(support_in(of)); }};
}

Record record_of(const Support &support) {
  Record record{"rigid_support",
                1,
                {{"lumped", {support.lumped ? 1.0 : 0.0}}},
                {{"boundary", support.boundary}},
                {{"normal", support.normal.record}, {"gap", support.gap.record}}};
  if (support.closed_ends) record.numbers["closed_ends"] = {1};
  if (support.body_normal) record.parts["body_normal"] = support.body_normal.record;
  add_friction(support.friction, record);
  return record;
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
