// Boundaries with loads or contact: on the surface, and those of contact in one piece over x.
#include "../core/refuses.hpp"
#include "rbvi/element/facet_forms.hpp"
#include "rbvi/mesh/contact_curves.hpp"
#include "rbvi/mesh/serial.hpp"
#include "tests/catalogue.hpp"

#include <cmath>

namespace rbvi::contact_curves_test {
namespace {

const std::string name = "contact";

Scene block() {
  return make_scene("patch", {{"bodies", "one"}});
}

double middle(const SerialMesh &mesh, const std::array<int, 3> &facet) {
  return (mesh.points[facet[0]][0] + mesh.points[facet[1]][0]) / 2;
}

TEST(ContactCurves, OnePieceOverXPasses) {
  const SerialMesh mesh = one_block();
  EXPECT_NO_THROW(check_contact_curves(mesh, block(), "the mesh"));
  SerialMesh turned = mesh; // the order of facets and of their ends does not matter
  for (auto &facet : turned.boundary[name])
    std::swap(facet[0], facet[1]);
  std::ranges::reverse(turned.boundary[name]);
  EXPECT_NO_THROW(check_contact_curves(turned, block(), "the mesh"));
}

TEST(ContactCurves, SeveralPiecesAreRefused) {
  for (const double gap : {0.3, 0.55}) {
    SerialMesh mesh = one_block();
    std::erase_if(mesh.boundary[name],
                  [&](const auto &facet) { return std::abs(middle(mesh, facet) - gap) < 0.1; });
    EXPECT_TRUE(refuses("the contact boundary 'contact' of the mesh is in several pieces: nothing "
                        "of it is between (",
                        [&] { check_contact_curves(mesh, block(), "the mesh"); }));
  }
}

TEST(ContactCurves, WhatIsNoGraphOverXIsRefused) {
  SerialMesh upright = one_block();
  upright.boundary[name].push_back(upright.boundary["sides"].front());
  EXPECT_TRUE(refuses("is no graph over x: its edge from (",
                      [&] { check_contact_curves(upright, block(), "the mesh"); }));
  SerialMesh doubled = one_block();
  for (const auto &facet : doubled.boundary["top"])
    doubled.boundary[name].push_back(facet);
  EXPECT_TRUE(refuses("is no graph over x: two of its edges lie above each other",
                      [&] { check_contact_curves(doubled, block(), "the mesh"); }));
}

using Ends = std::array<bool, 2>;

/// A polygon of so many edges about the origin, its triangles from there, with two of the edges.
SerialMesh polygon(int edges) {
  SerialMesh mesh;
  mesh.points = {{0, 0, 0}};
  for (int k = 0; k < edges; ++k) {
    const double angle = 2 * M_PI * k / edges - M_PI / 2;
    mesh.points.push_back({std::cos(angle), std::sin(angle), 0});
    mesh.cells.push_back({0, 1 + k, 1 + (k + 1) % edges, -1});
  }
  mesh.boundary[name] = {{edges, 1, -1}, {1, 2, -1}};
  return mesh;
}

TEST(ContactCurves, ABodyEndsWhereItsSurfaceTurnsAway) {
  EXPECT_EQ(closed_ends(one_block(), name), (Ends{true, true}));
  EXPECT_EQ(closed_ends(two_blocks(), "master"), (Ends{true, true}));
  for (const int edges : {8, 100}) {
    EXPECT_EQ(closed_ends(half_disc(edges), name), (Ends{false, false})) << "the arc goes on";
    EXPECT_EQ(closed_ends(refined(half_disc(edges)), name), (Ends{false, false}));
  }
  EXPECT_EQ(closed_ends(annulus(8), "top"), (Ends{false, false}));
  for (const char *arc : {"slave", "master"}) // from the axis of symmetry
    EXPECT_EQ(closed_ends(two_graded_quarter_discs(8), arc), (Ends{true, false}));
  EXPECT_EQ(closed_ends(polygon(8), name), (Ends{true, true})) << "a chamfer is no arc";
  EXPECT_EQ(closed_ends(polygon(12), name), (Ends{false, false})) << "a coarse circle is one";
  SerialMesh part = one_block();
  std::erase_if(part.boundary[name], [&](const auto &facet) { return middle(part, facet) > 0.5; });
  EXPECT_EQ(closed_ends(part, name), (Ends{true, false})) << "a part of a flat face";
}

TEST(ContactCurves, LoadsAndContactAreOnTheSurface) {
  Scene scene = block();
  scene.mesh.facts.clear();
  scene.mesh.boundaries.emplace_back("load");
  SerialMesh mesh = one_block();
  mesh.boundary["load"] = {mesh.boundary["sides"].front()};
  EXPECT_NO_THROW(check_facts(mesh, scene, "the mesh"));
  // An edge that two cells share.
  const auto &[a, b] = std::pair{mesh.cells[0], mesh.cells[1]};
  std::array<int, 3> inner{-1, -1, -1};
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i)
    if (std::ranges::count(b, a[i]) > 0) inner[count++] = a[i];
  ASSERT_EQ(count, 2u);
  mesh.boundary["load"] = {inner};
  EXPECT_NO_THROW(check_facts(mesh, scene, "the mesh")) << "nothing is there";
  scene.f.push_back(exact_term(pressure_load("load", 1, 2, 1)));
  const std::string refusal =
      "'load' of the mesh is not on the surface of the body: the facet from";
  EXPECT_TRUE(refuses(refusal, [&] { check_facts(mesh, scene, "the mesh"); }));
  scene.f.pop_back();
  scene.contacts.front().entities.parts = {"load"};
  EXPECT_TRUE(refuses(refusal, [&] { check_facts(mesh, scene, "the mesh"); }));
}

} // namespace
} // namespace rbvi::contact_curves_test
