#include "rbvi/contact/nitsche/nitsche_support.hpp"

#include "rbvi/contact/contact.hpp"
#include "rbvi/contact/curve.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/lagrange.hpp"

#include <utility>

namespace rbvi {

namespace {

/// The cells of the mesh as the terms take them.
std::vector<CurveCell> curve_cells(const InterfaceMesh &mesh) {
  if (mesh.dim != 2 || mesh.components != 2)
    throw bad_input("Nitsche's method is for two dimensions: the mesh has " +
                    std::to_string(mesh.dim));
  if (mesh.per_entity != nodes_per_cell(2, mesh.degree) ||
      static_cast<Index>(mesh.edges.size()) != mesh.count())
    throw bad_input("Nitsche's method needs triangles with an edge on the boundary");
  std::vector<CurveCell> cells;
  for (Index e = 0; e < mesh.count(); ++e) {
    const int *nodes = mesh.nodes_of(e);
    CurveCell cell{{2, {}, {}}, mesh.edges[e], {}};
    cell.dofs.fill(-1);
    for (std::size_t v = 0; v < 3; ++v)
      cell.cell.reference[v] = mesh.points[nodes[v]];
    cell.cell.mapped = cell.cell.reference;
    for (int i = 0; i < 2 * mesh.per_entity; ++i)
      cell.dofs[i] = mesh.dofs[2 * nodes[i / 2] + i % 2];
    cells.push_back(cell);
  }
  return cells;
}

/// The vertices of the curve, nodes of the mesh, by increasing x.
std::vector<Index> curve_vertices(const InterfaceMesh &mesh) {
  std::vector<Index> vertices;
  for (Index e = 0; e < mesh.count(); ++e) {
    const auto [i, j] = simplex_edges[mesh.edges[e]];
    Index a = mesh.nodes_of(e)[i], b = mesh.nodes_of(e)[j];
    if (mesh.points[a][0] > mesh.points[b][0]) std::swap(a, b);
    if (e == 0) vertices.push_back(a);
    vertices.push_back(b);
  }
  return vertices;
}

class NitscheInterface : public ContactInterface {
public:
  NitscheInterface(const Scene &scene, InterfaceMesh interface_mesh, NitscheCurve curve)
      : ContactInterface(scene, std::move(interface_mesh)), layer_{scene,
                                                                   {std::move(curve)},
                                                                   curve_cells(mesh_)} {
    dual_.vertices = curve_vertices(mesh_);
    for (const Index node : dual_.vertices)
      dual_.points.push_back(mesh_.points[node]);
    dual_.components = layer_.friction() ? 2 : 1;
    dual_.gram = linear_gram(dual_.points, dual_.components);
    for (const Index node : partly_fixed()) {
      std::array<bool, 2> &closed = layer_.curves.front().facing.closed_ends;
      if (node == 0) closed[0] = true;
      if (node + 1 == dual_.nodes()) closed[1] = true;
    }
  }

  const NitscheLayer *nitsche() const override { return &layer_; }
  void assemble(const FullMu &mu, const ContactState &, const WantedNodes &,
                ContactOperators &operators) override {
    std::vector<Point> mapped(mesh_.points.size());
    for (const Index node : dual_.vertices)
      mapped[node] = scene_.map(mu, mesh_.points[node]);
    set_constraints(mu, mapped, {}, {}, operators);
  }
  FrictionBound bound(const FullMu &mu) const override {
    return friction_bound(layer_.curves.front().law, mu);
  }
  PointConstraint constraint_at(const FullMu &mu, const Point &x, const Point &,
                                const Point &displacement) const override {
    const SupportPoint at = layer_.curves.front().facing.at(mu, x, displacement);
    return {at.normal, at.gap};
  }
  /// They come from the pressures along the curve: nitsche_outputs.
  void outputs(const FullMu &, const ContactOperators &, const Vector &, double,
               Outputs &) const override {}
  Grid fields(const FullMu &mu, const Vector &u, const Vector &lambda) override {
    return support_fields(scene_, mu, *this, u, lambda);
  }

private:
  NitscheLayer layer_;
};

/// `faced`: a Support or RigidSurface; `facing` makes of it what a curve faces.
template <class Faced, class MakeFacing>
ContactRecipe nitsche_contact(const std::string &name, Faced faced, double gamma0,
                              MakeFacing facing) {
  ContactRecipe recipe;
  recipe.entities = {InterfaceEntities::Kind::cells_beside, {faced.boundary}};
  recipe.formulation = Formulation::nitsche;
  add_friction(faced.friction, recipe);
  recipe.separable = false;
  recipe.make = [faced, gamma0, facing](const Scene &scene, InterfaceMesh mesh) {
    return std::make_unique<NitscheInterface>(
        scene, std::move(mesh), NitscheCurve{faced.friction, facing(scene, faced), gamma0});
  };
  recipe.record = record_of(faced);
  recipe.record.name = name;
  recipe.record.numbers["gamma0"] = {gamma0};
  return recipe;
}

} // namespace

NitscheLayer layer_of(const Contact &contact) {
  const auto one = [](const auto &interface) -> const NitscheLayer & {
    const NitscheLayer *layer = interface->nitsche();
    if (layer == nullptr) throw failure("the scene has contact by multipliers, not a curve");
    return *layer;
  };
  NitscheLayer all{one(contact.interfaces.front()).scene, {}, {}};
  for (const auto &interface : contact.interfaces) {
    const NitscheLayer &more = one(interface);
    for (CurveCell cell : more.cells) {
      cell.curve = static_cast<int>(all.curves.size());
      all.cells.push_back(cell);
    }
    all.curves.push_back(more.curves.front());
  }
  return all;
}

NitscheFacing facing_support(const Scene &scene, Support support) {
  const Named<PointMap> body_normal = support.body_normal;
  const std::array<bool, 2> closed_ends{support.closed_ends, support.closed_ends};
  return {[&scene, support = std::move(support)](const FullMu &mu, const Point &x, const Point &) {
            return support_point(scene, support, mu, x);
          },
          false, body_normal, closed_ends};
}

NitscheFacing facing_surface(const Scene &scene, RigidSurface surface) {
  return {[&scene, surface = std::move(surface)](const FullMu &mu, const Point &x,
                                                 const Point &displacement) {
            return surface_point(scene, surface, mu, x, displacement);
          },
          true};
}

ContactRecipe nitsche_support(Support support, double gamma0) {
  if (support.lumped)
    throw bad_input("-lumped yes is for contact by multipliers: leave out -formulation nitsche");
  ContactRecipe recipe =
      nitsche_contact("nitsche_support", std::move(support), gamma0, facing_support);
  recipe.record.version = 2; // 1: the stress was on the normal of contact
  return recipe;
}

ContactRecipe nitsche_half_plane(HalfPlane plane, double gamma0) {
  ContactRecipe recipe = half_plane(std::move(plane), [gamma0](const Support &support) {
    return nitsche_support(support, gamma0);
  });
  recipe.record.name = "nitsche_half_plane";
  recipe.record.version = 2; // of nitsche_support
  recipe.record.numbers["gamma0"] = {gamma0};
  return recipe;
}

ContactRecipe nitsche_surface(RigidSurface surface, double gamma0) {
  if (surface.body_normal || surface.lumped)
    throw bad_input("Nitsche's method takes the normal of the rigid surface, and Gauss points: "
                    "leave out the normal of the body, and vertex quadrature");
  return nitsche_contact("nitsche_surface", std::move(surface), gamma0, facing_surface);
}

ContactKind nitsche_support_kind() {
  return {"nitsche_support", 2,
          [](const Stored &of) { return nitsche_support(support_in(of), number(of, "gamma0")); }};
}

ContactKind nitsche_half_plane_kind() {
  return {"nitsche_half_plane", 2, [](const Stored &of) {
            return nitsche_half_plane(half_plane_in(of), number(of, "gamma0"));
          }};
}

ContactKind nitsche_surface_kind() {
  return {"nitsche_surface", 1,
          [](const Stored &of) { return nitsche_surface(surface_in(of), number(of, "gamma0")); }};
}

std::vector<SceneOption> nitsche_options() {
  return {{"formulation",
           "mixed",
           "of contact: with multipliers, or by Nitsche's method",
           {"mixed", "nitsche"}},
          {"nitsche_gamma0",
           "11.54",
           "Nitsche's gamma is this times (lambda + 2 shear modulus) over the length of an edge",
           {},
           {0.1, 2000}}};
}

bool asks_for_nitsche(const SceneOptions &options) {
  return options.at("formulation") == "nitsche";
}

ContactRecipe support_contact(Support support, const SceneOptions &options) {
  const double gamma0 = number_in(options, "nitsche_gamma0");
  return asks_for_nitsche(options) ? nitsche_support(std::move(support), gamma0)
                                   : rigid_support(std::move(support));
}

ContactRecipe half_plane_contact(HalfPlane plane, const SceneOptions &options) {
  const double gamma0 = number_in(options, "nitsche_gamma0");
  return asks_for_nitsche(options) ? nitsche_half_plane(std::move(plane), gamma0)
                                   : half_plane(std::move(plane));
}

ContactRecipe surface_contact(RigidSurface surface, const SceneOptions &options) {
  const double gamma0 = number_in(options, "nitsche_gamma0");
  return asks_for_nitsche(options) ? nitsche_surface(std::move(surface), gamma0)
                                   : rigid_surface(std::move(surface));
}

} // namespace rbvi
