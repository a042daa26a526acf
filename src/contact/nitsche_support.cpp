#include "rbvi/contact/nitsche_support.hpp"

#include "rbvi/contact/contact.hpp"
#include "rbvi/contact/curve.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/lagrange.hpp"

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
    cell.material = mesh.material_of(e);
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

class NitscheInterface : public ContactInterface {
public:
  NitscheInterface(const Scene &scene, InterfaceMesh interface_mesh, NitscheCurve curve)
      : ContactInterface(scene, std::move(interface_mesh)), layer_{scene,
                                                                   {std::move(curve)},
                                                                   curve_cells(mesh_)} {
    const auto [vertices, shape] = first_curve(mesh_);
    std::vector<int> number(mesh_.points.size(), -1);
    for (const int node : vertices) {
      number[node] = static_cast<int>(std::ssize(dual_.vertices));
      dual_.vertices.push_back(node);
      dual_.points.push_back(mesh_.points[node]);
    }
    dual_.components = layer_.friction() ? 2 : 1;
    dual_.gram = linear_gram(dual_.points, shape, dual_.components, scene.axisymmetric);
    for (Index e = 0; e < mesh_.count(); ++e)
      for (std::size_t end = 0; end < 2; ++end)
        layer_.cells[e].ends[end] =
            number[mesh_.nodes_of(e)[simplex_edges[layer_.cells[e].edge][end]]];
    ends_ = shape.ends;
    NitscheCurve &curve_here = layer_.curves.front();
    curve_here.facing = on_arcs(std::move(curve_here.facing), mesh_);
    check_body_normal(scene, curve_here.facing, mesh_);
    curve_here.middle = middle_of(scene.mirrors, dual_.points, is_one_open_piece(shape));
    curve_here.images = image_counts(scene.mirrors, dual_.points);
    for (std::size_t k = 0; k < shape.pieces.size(); ++k) {
      const CurveChain &piece = shape.pieces[k];
      const Index first = piece.first_vertex, last = first + piece.vertices() - 1;
      for (std::size_t end = 0; end < 2; ++end)
        if (!mesh_.closed(k)[end])
          curve_here.open_ends.push_back(static_cast<int>(end == 0 ? first : last));
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
    const Facing &facing = layer_.curves.front().facing;
    const FacedPoint at = facing.at(mu, place(scene_, facing, mu, x), displacement);
    return {at.normal, at.gap};
  }
  /// They come from the pressures along the curve: nitsche_outputs.
  void outputs(const FullMu &, const ContactOperators &, const Vector &, double,
               Outputs &) const override {}
  double gap_error(const FullMu &mu, const Vector &u, const Vector &lambda) const override {
    return rbvi::gap_error(*this, scene_, layer_.curves.front().facing, mu, u, lambda);
  }
  Grid fields(const FullMu &mu, const Vector &u, const Vector &lambda, bool whole) override {
    Grid grid =
        support_fields(*this, scene_, layer_.curves.front().facing, ends_, mu, u, lambda, whole);
    const CurveFields here = nitsche_fields(layer_, 0, mu, at_columns(mesh_, u));
    grid.of_nodes.push_back({"P_n", here.p_n, "Pa"});
    if (layer_.friction()) grid.of_nodes.push_back({"P_tau", here.p_tau, "Pa"});
    return grid;
  }

private:
  NitscheLayer layer_;
  std::vector<std::array<Index, 2>> ends_; ///< the vertices of each edge
};

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

ContactRecipe by_nitsche(const RigidContact &rigid, double gamma0) {
  if (rigid.facing.along_body)
    throw bad_input("Nitsche's method takes the normal of the rigid surface: leave out the normal "
                    "of the body");
  if (rigid.lumped)
    throw bad_input("-lumped yes is for contact by multipliers: leave out -formulation nitsche");
  ContactRecipe recipe;
  recipe.entities = {InterfaceEntities::Kind::cells_beside, {rigid.boundary}, {}, rigid.curved};
  recipe.formulation = Formulation::nitsche;
  add_friction(rigid.friction, recipe);
  recipe.separable = false;
  recipe.make = [rigid, gamma0](const Scene &scene, InterfaceMesh mesh) {
    return std::make_unique<NitscheInterface>(scene, std::move(mesh),
                                              NitscheCurve{rigid.friction, rigid.facing, gamma0});
  };
  return recipe;
}

} // namespace rbvi
