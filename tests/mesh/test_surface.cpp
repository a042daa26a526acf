// What of the surface of a mesh a scene says nothing of.
#include "gmsh_writer.hpp"
#include "rbvi/mesh/surface.hpp"
#include "temporary_file.hpp"
#include "tests/catalogue.hpp"
#include "triangles.hpp"

namespace rbvi::surface_test {
namespace {

using Names = std::vector<std::string>;

Names free_of(const SerialMesh &mesh, const Scene &scene) {
  return free_parts(mesh, surface_of(mesh, scene));
}

TEST(Surface, OfABlockOnAFloorTheSidesAreFree) {
  const Scene scene = make_scene("patch", {{"bodies", "one"}});
  const SerialMesh mesh = mesh_with_groups(scene, "");
  Scene held = scene;
  held.f.clear();
  held.fixed = {{"top", {}}};
  EXPECT_EQ(free_of(mesh, held), Names{"sides"});
  held.fixed.push_back({"sides", {0}});
  EXPECT_EQ(free_of(mesh, held), Names{});
  held.fixed.clear();
  held.f = {{{"", {}, "top"}, std::nullopt}}; // a load is something
  EXPECT_EQ(free_of(mesh, held), Names{"sides"});
}

TEST(Surface, OfAGroupThatOverlapsAnotherTheRestIsFree) {
  const Scene scene = make_scene("rigid_disk");
  const SerialMesh mesh = mesh_with_groups(scene, "");
  const auto all = mesh.boundary.at("arc").size(), touching = mesh.boundary.at("contact").size();
  EXPECT_EQ(free_of(mesh, scene), Names{"arc (" + std::to_string(all - touching) + " of " +
                                        std::to_string(all) + " facets)"});
}

/// A contact region is no part of the surface; groups that the case does not name are read.
TEST(Surface, GroupsAreThoseOfTheFile) {
  const Scene scene = make_scene("membrane_obstacle");
  SerialMesh drawn = square_with_disc();
  auto &sides = drawn.boundary.at("boundary");
  drawn.boundary["left"].assign(sides.begin(), sides.begin() + 3);
  const TemporaryFile file(written(drawing_of(drawn), {"4.1", false}));
  const SerialMesh mesh = mesh_with_groups(scene, file.name());
  EXPECT_EQ(mesh.boundary.at("left").size(), 3U);
  EXPECT_EQ(free_of(mesh, scene), Names{});
  Scene open = scene;
  open.fixed.clear();
  EXPECT_EQ(free_of(mesh, open), (Names{"boundary", "left"}));
}

TEST(Surface, FacetsInNoGroupAreToldWithTheirPlace) {
  Scene scene = make_scene("patch", {{"bodies", "one"}});
  SerialMesh mesh = mesh_with_groups(scene, "");
  scene.fixed = {{"top", {}}};
  const std::size_t count = mesh.boundary.at("sides").size();
  mesh.boundary.erase("sides");
  EXPECT_EQ(free_of(mesh, scene),
            Names{std::to_string(count) + " facets in no group, in [0, 1] x [0, 0.5]"});
}

} // namespace
} // namespace rbvi::surface_test
