// The parts of a mesh that contact interfaces are posed on: regions, several interfaces, and the
// same for any number of ranks. Curves: test_two_bodies.cpp, test_degree_two.cpp; cells beside a
// boundary: test_contact_layer.cpp.
#include "../core/refuses.hpp"
#include "rbvi/contact/contact.hpp"
#include "rbvi/contact/support.hpp"
#include "rbvi/fem/distributed_contact.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rbvi::interface_mesh_test {
namespace {

struct Placed {
  Scene scene;
  Mesh mesh;
  Dofs dofs;
  InterfacePlaces places;
  Placed(Scene of, const std::vector<FixedBoundary> &fixed, MPI_Comm comm = PETSC_COMM_WORLD)
      : scene(std::move(of)), mesh(make_mesh(comm, scene, {})),
        dofs(number_dofs(mesh, scene.components, fixed)),
        places(place_interfaces(mesh, dofs, scene)) {}
};

Placed membrane(MPI_Comm comm = PETSC_COMM_WORLD) {
  return {make_scene("membrane_obstacle"), {{"boundary", {}}}, comm};
}

ContactRecipe flat_support(const std::string &boundary) {
  return rigid_support({boundary,
                        [](const FullMu &, const Point &) {
                          return Point{0, -1, 0};
                        },
                        [](const FullMu &, const Point &) { return 0.0; }});
}

/// Two blocks, each on a support of its own.
Scene two_supports() {
  Scene scene = make_scene("patch", {{"degree", "2"}});
  scene.contacts = {flat_support("slave"), flat_support("master")};
  return scene;
}
const std::vector<FixedBoundary> held_above_and_below{{"top", {}}, {"bottom", {}}};

TEST(InterfaceMesh, OfARegionIsTheWholeDiscOnEveryRank) {
  const Placed m = membrane();
  ASSERT_EQ(m.places.meshes.size(), 1U);
  const InterfaceMesh &disc = m.places.meshes.front();
  EXPECT_EQ(disc.nodes(), 631);
  EXPECT_EQ(disc.columns, 631);
  EXPECT_EQ(disc.parts, std::vector<int>{631});
  EXPECT_EQ(disc.per_entity, 3);
  EXPECT_TRUE(disc.edges.empty());
  for (const Point &x : disc.points)
    EXPECT_LE(std::hypot(x[0], x[1]), 0.2 + 1e-12);
  const FullMu mu{0.16, 0.05, 0};
  ContactOperators operators;
  assemble(make_contact(m.scene, m.places.meshes), mu, {}, operators);
  const double area = std::numbers::pi * mu[0] * mu[0];
  EXPECT_NEAR(operators.b.sum(), -area, 2e-3 * area);
  EXPECT_EQ(m.places.trace.size, 631);
  int owned = static_cast<int>(m.places.trace.index.size());
  MPI_Allreduce(MPI_IN_PLACE, &owned, 1, MPI_INT, MPI_SUM, m.mesh.comm);
  EXPECT_EQ(owned, 631);
}

/// Every column is the dof of the node that the mesh says.
void expect_trace_of_nodes(const Placed &placed) {
  const Dofs &dofs = placed.dofs;
  const Vector natural = Vector::LinSpaced(dofs.total, 1, 2);
  const Vector trace = restrict_to(placed.places.trace, from_natural(dofs, natural).get());
  ASSERT_EQ(trace.size(), static_cast<Index>(placed.places.natural_dofs.size()));
  for (Index i = 0; i < trace.size(); ++i)
    EXPECT_EQ(trace[i], natural[placed.places.natural_dofs[i]]);
  for (std::size_t k = 0; k < placed.places.meshes.size(); ++k) {
    const InterfaceMesh &mesh = placed.places.meshes[k];
    for (Index i = 0; i < mesh.nodes() * mesh.components; ++i)
      if (const int dof = mesh.dofs[i]; dof >= 0) {
        EXPECT_EQ(placed.places.natural_dofs[dof],
                  placed.places.natural_nodes[k][i / mesh.components] * mesh.components +
                      i % mesh.components);
      }
  }
}

TEST(InterfaceMesh, TheTraceFollowsTheNodes) {
  expect_trace_of_nodes(membrane());
  expect_trace_of_nodes({two_supports(), held_above_and_below});
}

/// A vertex of the disc that is held has no column and no multiplier.
TEST(InterfaceMesh, HeldDofsOfARegionHaveNoColumn) {
  Mesh mesh = membrane().mesh;
  const Scene scene = make_scene("membrane_obstacle");
  mesh.boundary["disc's lower half"].assign(mesh.points.size(), false);
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    mesh.boundary["disc's lower half"][v] = mesh.points[v][1] < -1e-9;
  const Dofs dofs = number_dofs(mesh, 1, {{"disc's lower half", {}}});
  const InterfacePlaces places = place_interfaces(mesh, dofs, scene);
  const InterfaceMesh &disc = places.meshes.front();
  EXPECT_EQ(disc.nodes(), 631);
  EXPECT_LT(disc.columns, 400);
  for (Index i = 0; i < disc.nodes(); ++i)
    EXPECT_EQ(disc.dofs[i] < 0, disc.points[i][1] < -1e-9);
  ContactOperators operators;
  assemble(make_contact(scene, places.meshes), {0.2, 0, 0}, {}, operators);
  EXPECT_EQ(operators.b.rows(), disc.columns);
  EXPECT_EQ(operators.b.cols(), disc.columns);
}

TEST(InterfaceMesh, SeveralInterfacesHaveColumnsOneAfterTheOther) {
  const Placed placed(two_supports(), held_above_and_below);
  ASSERT_EQ(placed.places.meshes.size(), 2U);
  const InterfaceMesh &upper = placed.places.meshes[0], &lower = placed.places.meshes[1];
  const Index columns = 2 * (upper.nodes() + lower.nodes());
  EXPECT_EQ(upper.columns, columns);
  EXPECT_EQ(lower.columns, columns);
  EXPECT_EQ(static_cast<Index>(placed.places.natural_dofs.size()), columns);
  for (Index i = 0; i < 2 * upper.nodes(); ++i)
    EXPECT_EQ(upper.dofs[i], i);
  for (Index i = 0; i < 2 * lower.nodes(); ++i)
    EXPECT_EQ(lower.dofs[i], 2 * upper.nodes() + i);
}

TEST(InterfaceMesh, IsTheSameOnAnyNumberOfRanks) {
  const auto expect_same = [](const Placed &many, const Placed &one) {
    EXPECT_EQ(many.places.natural_dofs, one.places.natural_dofs);
    EXPECT_EQ(many.places.natural_nodes, one.places.natural_nodes);
    ASSERT_EQ(many.places.meshes.size(), one.places.meshes.size());
    for (std::size_t k = 0; k < one.places.meshes.size(); ++k) {
      const InterfaceMesh &a = many.places.meshes[k], &b = one.places.meshes[k];
      EXPECT_EQ(a.points, b.points);
      EXPECT_EQ(a.entities, b.entities);
      EXPECT_EQ(a.edges, b.edges);
      EXPECT_EQ(a.parts, b.parts);
      EXPECT_EQ(a.dofs, b.dofs);
      EXPECT_EQ(a.columns, b.columns);
    }
  };
  expect_same(membrane(), membrane(PETSC_COMM_SELF));
  expect_same({two_supports(), held_above_and_below},
              {two_supports(), held_above_and_below, PETSC_COMM_SELF});
  const Scene nitsche = make_scene("rigid_disk", {{"arc_edges", "8"}, {"formulation", "nitsche"}});
  expect_same({nitsche, nitsche.fixed}, {nitsche, nitsche.fixed, PETSC_COMM_SELF});
}

/// Cells beside two curves may be the same, edges not.
TEST(InterfaceMesh, TwoCurvesOfCellsDoNotShareAnEdge) {
  Scene scene = make_scene("rigid_disk", {{"arc_edges", "8"}, {"formulation", "nitsche"}});
  scene.contacts.push_back(scene.contacts.front());
  scene.contacts.back().name = "other";
  EXPECT_TRUE(refuses(
      "contact 'support' on 'contact' and contact 'other' on 'contact' share the edge from (",
      [&] { Placed(scene, scene.fixed); }));
}

TEST(InterfaceMesh, TwoInterfacesDoNotConstrainTheSameDisplacement) {
  Scene scene = make_scene("membrane_obstacle");
  scene.contacts.push_back(scene.contacts.front());
  EXPECT_TRUE(refuses("contact 'obstacle' on 'obstacle' and contact 'obstacle' on 'obstacle' both "
                      "constrain the displacement along x at (",
                      [&] {
                        Placed(scene, {{"boundary", {}}});
                      }));
  scene = two_supports();
  scene.contacts.push_back(flat_support("slave again"));
  Placed placed(two_supports(), held_above_and_below);
  placed.mesh.boundary["slave again"] = placed.mesh.boundary.at("slave");
  placed.mesh.curves["slave again"] = placed.mesh.curves.at("slave");
  placed.mesh.facets["slave again"] = placed.mesh.facets.at("slave");
  EXPECT_TRUE(refuses("on 'slave' and contact on 'slave again' share the edge from (",
                      [&] { (void)place_interfaces(placed.mesh, placed.dofs, scene); }));
}

TEST(InterfaceMesh, ARegionNeedsACell) {
  Mesh mesh = membrane().mesh;
  const Dofs dofs = number_dofs(mesh, 1, {{"boundary", {}}});
  mesh.region.at("obstacle").assign(mesh.cells.size(), false);
  EXPECT_TRUE(refuses("no cell in region 'obstacle'", [&] {
    (void)place_interfaces(mesh, dofs, make_scene("membrane_obstacle"));
  }));
}

} // namespace
} // namespace rbvi::interface_mesh_test
