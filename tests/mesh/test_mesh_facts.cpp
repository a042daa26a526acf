// What a scene asks of its mesh: the built-in ones have it, meshes of another size, place or shape
// are refused by the name of the part that is wrong.
#include "gmsh_writer.hpp"
#include "rbvi/contact/pair.hpp"
#include "rbvi/core/error.hpp"
#include "temporary_file.hpp"
#include "tests/catalogue.hpp"
#include "triangles.hpp"

#include <functional>

namespace rbvi::mesh_facts_test {
namespace {

/// The built-in mesh of a scene.
SerialMesh built(const Scene &scene) {
  const std::string &name = scene.mesh.generator;
  if (name == "square_with_disc")
    return scene.mesh.edges == 0 ? square_with_disc() : square_with_disc(scene.mesh.edges);
  if (name == "two_quarter_discs") return two_quarter_discs();
  if (name == "two_graded_quarter_discs") return two_graded_quarter_discs(scene.mesh.edges);
  if (name == "two_blocks") return two_blocks();
  return name == "one_block" ? one_block() : half_disc(scene.mesh.edges == 0 ? 100 : 316);
}

struct SceneCase {
  std::string name;
  SceneOptions options;
};

const std::vector<SceneCase> scenes{{"membrane_obstacle", {}},
                                    {"membrane_obstacle", {{"lumped", "no"}}},
                                    {"two_disks", {}},
                                    {"rigid_disk", {}},
                                    {"rigid_disk", {{"formulation", "nitsche"}}},
                                    {"patch", {}},
                                    {"patch", {{"bodies", "one"}}}};

TEST(MeshFacts, TheBuiltInMeshesOfAllScenesAndTheirRefinementsPass) {
  for (const SceneCase &c : scenes) {
    const Scene scene = make_scene(c.name, c.options);
    SCOPED_TRACE(scene.mesh.generator);
    EXPECT_NO_THROW(check_facts(built(scene), scene, "the mesh"));
    EXPECT_NO_THROW((void)make_mesh(PETSC_COMM_WORLD, scene, {"", 1}));
  }
}

TEST(MeshFacts, EveryPartOfEverySceneHasOne) {
  for (const SceneCase &c : scenes) {
    const Scene scene = make_scene(c.name, c.options);
    std::vector<std::string> parts = scene.mesh.regions;
    parts.insert(parts.end(), scene.mesh.boundaries.begin(), scene.mesh.boundaries.end());
    parts.emplace_back("");
    for (const std::string &part : parts)
      EXPECT_TRUE(std::any_of(scene.mesh.facts.begin(), scene.mesh.facts.end(),
                              [&](const MeshFact &fact) {
                                return fact.part == part && fact.distance && fact.size > 0;
                              }))
          << c.name << " '" << part << "'";
  }
}

using Change = std::function<void(SerialMesh &)>;

Change moved(const std::function<Point(const Point &)> &where) {
  return [where](SerialMesh &mesh) {
    for (Point &x : mesh.points)
      x = where(x);
  };
}

Change scaled(double factor) {
  return moved([factor](const Point &x) -> Point { return {factor * x[0], factor * x[1], 0}; });
}

Change shifted(double dx, double dy) {
  return moved([=](const Point &x) -> Point { return {x[0] + dx, x[1] + dy, 0}; });
}

/// Keeps the facets of a boundary whose middles fulfil the condition.
Change only(const std::string &boundary, const std::function<bool(const Point &)> &kept) {
  return [=](SerialMesh &mesh) {
    std::erase_if(mesh.boundary.at(boundary), [&](const auto &facet) {
      const Point &x = mesh.points[facet[0]], &y = mesh.points[facet[1]];
      return !kept({(x[0] + y[0]) / 2, (x[1] + y[1]) / 2, 0});
    });
  };
}

Change without_last(const std::string &part) {
  return [=](SerialMesh &mesh) {
    if (mesh.region.contains(part))
      mesh.region[part].pop_back();
    else
      mesh.boundary[part].pop_back();
  };
}

Change exchanged(const std::string &a, const std::string &b) {
  return [=](SerialMesh &mesh) { std::swap(mesh.boundary[a], mesh.boundary[b]); };
}

/// Gives the cells on the right vertices of their own.
void tear(SerialMesh &mesh) {
  const auto right = [&](int cell) {
    const auto x = corners(mesh, cell);
    return x[0][0] + x[1][0] + x[2][0] > 0.1;
  };
  std::map<int, int> copy; // of what both sides have
  std::set<int> left;
  for (const int c : all_cells(mesh))
    if (!right(c)) left.insert(mesh.cells[c].begin(), mesh.cells[c].begin() + 3);
  const auto cells = cells_of_edges(mesh);
  std::vector<bool> on_right;
  for (const int c : all_cells(mesh))
    on_right.push_back(right(c));
  const auto replace = [&](int &v) {
    if (!left.contains(v)) return;
    const auto [own, is_new] = copy.try_emplace(v, static_cast<int>(mesh.points.size()));
    if (is_new) mesh.points.push_back(Point(mesh.points[v]));
    v = own->second;
  };
  for (auto &[name, facets] : mesh.boundary)
    for (auto &facet : facets)
      if (on_right[cells.at(sorted(facet[0], facet[1])).front()])
        for (std::size_t i = 0; i < 2; ++i)
          replace(facet[i]);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (std::size_t i = 0; on_right[c] && i < 3; ++i)
      replace(mesh.cells[c][i]);
}

/// Removes a cell of the core of the half disk.
void pierce(SerialMesh &mesh) {
  int hole = 0;
  for (const int c : all_cells(mesh)) {
    const auto x = corners(mesh, c);
    const bool inside = std::all_of(x.begin(), x.begin() + 3, [](const Point &y) {
      return std::hypot(y[0], y[1]) < 0.5 && y[1] < -0.1;
    });
    if (inside) hole = c;
  }
  mesh.cells.erase(mesh.cells.begin() + hole);
  std::vector<int> &core = mesh.region.at("core");
  std::erase(core, hole);
  for (int &cell : core)
    cell -= cell > hole ? 1 : 0;
}

/// Lays another mesh over a mesh.
void overlay(SerialMesh &mesh, const SerialMesh &other) {
  const int points = static_cast<int>(mesh.points.size()),
            cells = static_cast<int>(mesh.cells.size());
  mesh.points.insert(mesh.points.end(), other.points.begin(), other.points.end());
  for (const auto &cell : other.cells)
    mesh.cells.push_back({cell[0] + points, cell[1] + points, cell[2] + points, -1});
  for (const auto &[name, own] : other.region)
    for (const int cell : own)
      mesh.region[name].push_back(cell + cells);
  for (const auto &[name, own] : other.boundary)
    for (const auto &facet : own)
      mesh.boundary[name].push_back({facet[0] + points, facet[1] + points, -1});
}

void expect_refused(const std::function<void()> &work, const std::vector<std::string> &hints) {
  try {
    work();
    FAIL() << "accepted; expected: " << hints.front();
  } catch (const Error &error) {
    const std::string message = error.what();
    EXPECT_EQ(error.status(), Status::bad_input) << message;
    for (const std::string &hint : hints)
      EXPECT_NE(message.find(hint), std::string::npos) << message << "\nexpected: " << hint;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

struct Wrong {
  SceneCase scene;
  Change change;
  std::vector<std::string> hints;
};

void expect_all_refused(const std::vector<Wrong> &cases) {
  for (const Wrong &c : cases) {
    SCOPED_TRACE(c.scene.name + ": " + c.hints.front());
    const Scene scene = make_scene(c.scene.name, c.scene.options);
    SerialMesh mesh = built(scene);
    c.change(mesh);
    ASSERT_NO_THROW(check_mesh(mesh, "my mesh"));
    expect_refused([&] { check_facts(mesh, scene, "my mesh"); }, c.hints);
  }
}

const SceneCase membrane{"membrane_obstacle", {}}, disks{"two_disks", {}}, disk{"rigid_disk", {}},
    blocks{"patch", {}}, block{"patch", {{"bodies", "one"}}};

TEST(MeshFacts, AnotherSizeOrPlaceIsRefused) {
  const std::string square = "my mesh is not the square of side 1 about the origin: vertex (";
  const std::string half = "my mesh is not the half y <= 0 of the disk of radius 1";
  expect_all_refused(
      {{membrane, scaled(1000), {square, "is 706.4 away", "-help -case FILE"}},
       {membrane, shifted(3, 0), {square, "is 3 away"}},
       {membrane, shifted(0, 2e-6), {square, "is 2e-06 away"}},
       {disk,
        scaled(0.8),
        {"'contact' of my mesh is not the arc of radius 1", "is 0.2 away from it"}},
       {disk, scaled(1000), {half, "is 999 away"}},
       {disk, shifted(0, -2), {half, "is 2 away"}},
       {disk,
        moved([](const Point &x) -> Point {
          return {-x[0], -x[1], 0};
        }),
        {half, "is 1"}},
       {disks, scaled(1.1), {"my mesh is not two quarter disks"}},
       {disks,
        moved([](const Point &x) -> Point {
          return {x[0], x[1] - (x[1] > 0 ? 0.5 : -0.5), 0};
        }),
        {"my mesh is not two quarter disks", "is 0.5 away"}},
       {blocks, scaled(1000), {"my mesh is not two blocks"}},
       {block, shifted(0, 0.25), {"my mesh is not the block [0, 1] x [0, 0.5]", "is 0.25 away"}}});
}

TEST(MeshFacts, RegionsAreWholeAndFitTheirRims) {
  expect_all_refused(
      {{membrane,
        without_last("obstacle"),
        {"'obstacle' of my mesh", "the cell about (", "missing"}},
       {membrane,
        [](SerialMesh &mesh) { mesh.region["obstacle"].push_back(6000); },
        {"'obstacle' of my mesh is not the disk of radius 0.2", "away from it"}},
       {membrane,
        moved([](const Point &x) -> Point {
          const double factor = std::hypot(x[0], x[1]) < 0.21 ? 0.95 : 1;
          return {factor * x[0], factor * x[1], 0};
        }),
        {"'obstacle' of my mesh", "lies 0.01 inside it: the edges of the mesh must fit its rim"}},
       {disk, without_last("core"), {"'core' of my mesh", "missing"}},
       {disks, without_last("upper"), {"'upper' of my mesh", "missing"}},
       {disks,
        [](SerialMesh &mesh) { std::swap(mesh.region["upper"], mesh.region["lower"]); },
        {"'upper' of my mesh", "away from it"}},
       {blocks, without_last("lower"), {"'lower' of my mesh", "missing"}}});
}

TEST(MeshFacts, BoundariesAreWholeAndInPlace) {
  const auto left = [](const Point &x) { return x[0] < 0; };
  expect_all_refused(
      {{membrane,
        without_last("boundary"),
        {"'boundary' of my mesh is not all four sides",
         "has 175 facets and lacks 1, the facet from"}},
       {membrane, only("boundary", left), {"has 88 facets and lacks 88, "}},
       {disk,
        only("contact", left),
        {"'contact' of my mesh is not", "has 50 facets and lacks 50, "}},
       {disk,
        only("arc", [](const Point &x) { return x[1] > -std::cos(std::numbers::pi / 8); }),
        {"'contact' of my mesh is not the arc of radius 1", "is not in 'arc'"}},
       {disk,
        only("arc", [](const Point &x) { return x[1] < -0.1; }),
        {"'arc' of my mesh is not the whole half circle of radius 1, 'contact' included",
         "and lacks "}},
       {disk,
        only("contact", [](const Point &x) { return std::abs(x[0]) > 0.01; }),
        {"'contact' of my mesh", "lacks 2"}},
       {disk, without_last("top"), {"'top' of my mesh is not the flat side y = 0", "lacks 1"}},
       {disk,
        [](SerialMesh &mesh) { mesh.boundary["contact"] = mesh.boundary["arc"]; },
        {"'contact' of my mesh is not the arc of radius 1 within 22.5 degrees", "away from it"}},
       {disks, exchanged("slave", "master"), {"'slave' of my mesh", "away from it"}},
       {disks, without_last("axis"), {"'axis' of my mesh", "lacks 1"}},
       {disks, exchanged("top", "bottom"), {"'top' of my mesh", "is 3 away from it"}},
       {blocks, without_last("sides"), {"'sides' of my mesh", "lacks 1"}},
       {block, exchanged("top", "contact"), {"'top' of my mesh", "is 0.5 away from it"}}});
}

TEST(MeshFacts, AFacetInsideTheBodyIsNoBoundary) {
  const Scene scene = make_scene(block.name, block.options);
  SerialMesh mesh = built(scene);
  // A cell in a corner has two facets on the surface; its third one cuts the corner.
  std::map<Edge, std::vector<int>> edges = cells_of_edges(mesh);
  for (const auto &cell : mesh.cells)
    for (std::size_t i = 0; i < 3; ++i) {
      const int a = cell[i], b = cell[(i + 1) % 3], c = cell[(i + 2) % 3];
      if (edges[sorted(a, b)].size() == 1 && edges[sorted(b, c)].size() == 1)
        mesh.boundary["sides"].push_back({c, a, -1});
    }
  Scene open = scene;
  for (MeshFact &fact : open.mesh.facts)
    fact.distance = nullptr;
  expect_refused([&] { check_facts(mesh, open, "my mesh"); },
                 {"'sides' of my mesh", "has cells on both sides"});
}

TEST(MeshFacts, PartsThatAreNotGluedHolesAndOverlapsAreNamed) {
  expect_all_refused(
      {{membrane, tear, {"facets lie on top of others without common nodes", "glue the parts"}},
       {disk, tear, {"facets lie on top of others without common nodes"}},
       {disk, pierce, {"3 facets of its surface lie inside, the facet from (", "a hole"}},
       {membrane,
        [](SerialMesh &mesh) { overlay(mesh, SerialMesh(mesh)); },
        {"176 facets lie on top of others without common nodes"}},
       {membrane,
        [](SerialMesh &mesh) {
          SerialMesh fine = refined(mesh);
          snap_curves(fine, make_scene("membrane_obstacle"));
          overlay(mesh, fine);
        },
        {"my mesh is not the square", "its area is 2, not 1: cells overlap"}}});
}

TEST(MeshFacts, TwoBodiesMayTouchAlongTheirContactCurves) {
  Scene scene;
  scene.name = "stacked";
  scene.mesh = {"", {}, {"slave", "master"}};
  SerialMesh mesh = one_block();
  SerialMesh lower = mesh;
  for (Point &x : lower.points)
    x[1] = -x[1];
  for (auto &cell : lower.cells)
    std::swap(cell[0], cell[1]);
  lower.boundary = {{"master", lower.boundary["contact"]}};
  mesh.boundary = {{"slave", mesh.boundary["contact"]}};
  overlay(mesh, lower);
  ASSERT_NO_THROW(check_mesh(mesh, "my mesh"));
  expect_refused([&] { check_facts(mesh, scene, "my mesh"); }, {"8 facets lie on top of others"});
  scene.contacts = {two_bodies({"slave", "master", {}})};
  EXPECT_NO_THROW(check_facts(mesh, scene, "my mesh"));
}

TEST(MeshFacts, SizesAreTold) {
  Scene scene = make_scene(block.name, block.options);
  scene.mesh.facts = {{"", "a large body", {}, 1}};
  expect_refused([&] { check_facts(one_block(), scene, "my mesh"); },
                 {"my mesh is not a large body: its area is 0.5, not 1: it is too coarse, or not"});
  scene.mesh.facts = {{"top", "a long side", {}, 2}};
  expect_refused([&] { check_facts(one_block(), scene, "my mesh"); },
                 {"'top' of my mesh is not a long side: its length is 1, not 2"});
}

TEST(MeshFacts, CellsWithoutAMaterialAreRefused) {
  Scene scene = make_scene(block.name, block.options);
  scene.mesh.regions = {"part"};
  for (Term &term : scene.a)
    term.form.region = "part";
  SerialMesh mesh = one_block();
  mesh.region["part"] = all_cells(mesh);
  EXPECT_NO_THROW(check_facts(mesh, scene, "my mesh"));
  mesh.region["part"].erase(mesh.region["part"].begin());
  expect_refused([&] { check_facts(mesh, scene, "my mesh"); },
                 {"my mesh has cells without a material, 1 of 80", "write 'at: all'"});
}

/// A body with a round hole is larger by what polygons leave of the hole.
TEST(MeshFacts, ASizeMayHaveAnExcess) {
  Scene scene = make_scene(block.name, block.options);
  scene.mesh.facts = {{"", "a small body", {}, 0.46}};
  expect_refused([&] { check_facts(one_block(), scene, "my mesh"); },
                 {"its area is 0.5, not 0.46"});
  scene.mesh.facts.front().excess = 0.1;
  EXPECT_NO_THROW(check_facts(one_block(), scene, "my mesh"));
}

TEST(MeshFacts, APartThatTheRecipeDoesNotNameIsRefused) {
  Scene scene = make_scene(block.name, block.options);
  scene.mesh.facts.front().within = "wall";
  expect_refused([&] { check_facts(one_block(), scene, "my mesh"); },
                 {"scene patch speaks of 'wall', which is no region or boundary"});
}

TEST(MeshFacts, AfterARefinementCurvesAreStillInPlace) {
  Scene scene = make_scene("rigid_disk");
  scene.curves.clear();
  expect_refused(
      [&] {
        (void)make_mesh(PETSC_COMM_WORLD, scene, {"", 1});
      },
      {"of the built-in mesh, refined 1 times is not"});
}

/// Of any boundary, with contact or without, before refinement moves a vertex there.
TEST(MeshFacts, ACurveThatAVertexIsNotOnIsRefused) {
  Scene scene = make_scene("rigid_disk");
  for (const std::string name : {"arc", "contact", "core"}) {
    scene.curves = {{name, [](const Point &x) { return 1.001 * x; }}};
    expect_refused(
        [&] {
          (void)make_mesh(PETSC_COMM_WORLD, scene, {"", 1});
        },
        {"'" + name + "' of the built-in mesh", "0.0", "away from its circle"});
  }
}

/// Edges along an arc that no curve of the case snaps stay straight.
TEST(MeshFacts, FactsOfACaseAreThoseOfItsFile) {
  Scene scene = make_scene("rigid_disk");
  scene.curves.clear();
  scene.mesh.inclusion = {};
  scene.mesh.generator = "";
  const TemporaryFile file(written(drawing_of(half_disc()), {"4.1", false}));
  EXPECT_NO_THROW((void)make_mesh(PETSC_COMM_WORLD, scene, {file.name(), 1}));
}

TEST(MeshFacts, AFacetOfABoundaryIsOneOfACell) {
  SerialMesh mesh = square_with_disc();
  mesh.boundary["boundary"].push_back({0, 3500, -1});
  expect_refused([&] { check_mesh(mesh, "my mesh"); },
                 {"my mesh: a facet of 'boundary' at (", "is on no cell"});
}

TEST(MeshFacts, ABuiltInMeshWithoutANameOfTheSceneIsRefused) {
  Scene scene = make_scene("membrane_obstacle");
  scene.mesh.boundaries.emplace_back("wall");
  expect_refused([&] { (void)make_mesh(PETSC_COMM_WORLD, scene, {}); },
                 {"makes no boundary 'wall'"});
}

TEST(MeshFacts, FilesAreCheckedOnEveryRank) {
  for (const SceneCase &c : scenes)
    for (const double factor : {1.0, 0.8}) {
      const Scene scene = make_scene(c.name, c.options);
      SerialMesh mesh = built(scene);
      scaled(factor)(mesh);
      const TemporaryFile file(written(drawing_of(mesh), {"4.1", true}));
      const auto make = [&] { (void)make_mesh(PETSC_COMM_WORLD, scene, {file.name(), 0}); };
      if (factor == 1)
        EXPECT_NO_THROW(make()) << c.name;
      else
        expect_refused(make, {"mesh file '" + file.name() + "' is not ", " away from it"});
    }
}

} // namespace
} // namespace rbvi::mesh_facts_test
