// The built-in meshes of one body on a rigid support: the half disc, and the block of the patch
// test.
#include "rbvi/core/error.hpp"
#include "triangles.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace rbvi::half_disc_test {
namespace {

constexpr double pi = std::numbers::pi;

double radius(const Point &x) {
  return std::hypot(x[0], x[1]);
}

Scene half_disc_scene(int edges) {
  Scene scene;
  scene.name = "disc_on_support";
  scene.components = 2;
  scene.mesh = {"half_disc", {"core"}, {"top", "contact", "arc"}, edges};
  scene.mesh.inclusion = {"core", {0, 0, 0}, 0.6};
  scene.curves["arc"] = [](const Point &x) -> Point {
    return {x[0] / radius(x), x[1] / radius(x), 0};
  };
  return scene;
}

Scene one_block_scene() {
  Scene scene;
  scene.name = "block_on_support";
  scene.components = 2;
  scene.mesh = {"one_block", {}, {"sides", "top", "contact"}};
  return scene;
}

std::multiset<std::string> boundaries_of_half_disc(const Point &x, const Point &y) {
  if (x[1] == 0 && y[1] == 0) return {"top"};
  if (std::max(std::abs(radius(x) - 1), std::abs(radius(y) - 1)) > 1e-14) return {};
  const double highest = -std::cos(pi / 8) + 1e-14;
  if (std::max(x[1], y[1]) > highest) return {"arc"};
  return {"arc", "contact"};
}

std::multiset<std::string> boundaries_of_block(const Point &x, const Point &y) {
  if (x[0] == y[0] && (x[0] == 0 || x[0] == 1)) return {"sides"};
  if (x[1] != y[1]) return {};
  const std::map<double, std::string> names{{0.5, "top"}, {0, "contact"}};
  return {names.at(x[1])};
}

/// For each node the one with the opposite x, bit by bit; -1 if there is none.
std::vector<int> mirror_images(const SerialMesh &mesh) {
  std::map<Point, int> node;
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    node[mesh.points[v]] = static_cast<int>(v);
  EXPECT_EQ(node.size(), mesh.points.size());
  std::vector<int> images;
  for (const Point &x : mesh.points) {
    const auto found = node.find({-x[0], x[1], 0});
    images.push_back(found == node.end() ? -1 : found->second);
  }
  return images;
}

/// The vertices of each simplex, replaced by their images, whatever their order.
template <class Simplices>
std::multiset<std::set<int>> vertex_sets(const Simplices &simplices, int vertices,
                                         const std::vector<int> &images) {
  std::multiset<std::set<int>> sets;
  for (const auto &simplex : simplices) {
    std::set<int> own;
    for (int i = 0; i < vertices; ++i)
      own.insert(images[simplex[i]]);
    sets.insert(own);
  }
  return sets;
}

class HalfDisc : public testing::TestWithParam<int> {
protected:
  const SerialMesh mesh = half_disc(GetParam());
};
INSTANTIATE_TEST_SUITE_P(Edges, HalfDisc, testing::Values(8, 20, 100, 200, 316, 400));

TEST_P(HalfDisc, IsWellShapedAndFillsThePolygon) {
  EXPECT_NO_THROW(check_mesh(mesh, "half disc"));
  // Fine meshes are graded more steeply towards the clamped corners.
  EXPECT_LE(worst_aspect_ratio(mesh), GetParam() > 200 ? 2 : 1.65);
  EXPECT_LT(range_of_edges(mesh).second, 0.22);
  EXPECT_LE(largest_jump(mesh), 2.5);
  double polygon = 0; // of the origin and the edges of the arc
  for (const auto &facet : mesh.boundary.at("arc")) {
    const Point &x = mesh.points[facet[0]], &y = mesh.points[facet[1]];
    polygon += 0.5 * std::abs(x[0] * y[1] - x[1] * y[0]);
  }
  EXPECT_NEAR(area(mesh, all_cells(mesh)), polygon, 1e-13);
  EXPECT_LT(pi / 2 - polygon, 0.01);
}

TEST_P(HalfDisc, BoundariesAreCompleteAndExact) {
  expect_boundaries(mesh, boundaries_of_half_disc);
  const std::vector<Point> arc = points_of(mesh, "arc"), top = points_of(mesh, "top");
  for (const Point &x : arc)
    EXPECT_NEAR(radius(x), 1, 1e-15);
  for (const auto &nodes : {arc, top}) {
    EXPECT_EQ(nodes.front(), (Point{-1, 0, 0}));
    EXPECT_EQ(nodes.back(), (Point{1, 0, 0}));
  }
}

TEST_P(HalfDisc, ContactArcHasEqualEdges) {
  const std::vector<Point> contact = points_of(mesh, "contact");
  ASSERT_EQ(contact.size(), at(GetParam() + 1));
  EXPECT_EQ(mesh.boundary.at("contact").size(), at(GetParam()));
  EXPECT_NEAR(std::atan2(contact.front()[1], contact.front()[0]), -5 * pi / 8, 1e-15);
  EXPECT_NEAR(std::atan2(contact.back()[1], contact.back()[0]), -3 * pi / 8, 1e-15);
  EXPECT_EQ(contact[GetParam() / 2], (Point{0, -1, 0}));
  for (std::size_t i = 1; i < contact.size(); ++i)
    EXPECT_NEAR(length(contact[i], contact[i - 1]), 2 * std::sin(pi / 8 / GetParam()), 1e-15);
}

TEST_P(HalfDisc, IsItsOwnMirrorImage) {
  const std::vector<int> images = mirror_images(mesh);
  ASSERT_EQ(std::count(images.begin(), images.end(), -1), 0);
  std::vector<int> same(images.size());
  for (std::size_t v = 0; v < same.size(); ++v)
    same[v] = static_cast<int>(v);
  EXPECT_EQ(vertex_sets(mesh.cells, 3, images), vertex_sets(mesh.cells, 3, same));
  for (const auto &[name, facets] : mesh.boundary)
    EXPECT_EQ(vertex_sets(facets, 2, images), vertex_sets(facets, 2, same)) << name;
  std::vector<std::array<int, 4>> core;
  for (const int cell : mesh.region.at("core"))
    core.push_back(mesh.cells[cell]);
  EXPECT_EQ(vertex_sets(core, 3, images), vertex_sets(core, 3, same));
}

TEST_P(HalfDisc, FitsTheCore) {
  std::vector<bool> in_core(mesh.cells.size(), false);
  for (const int cell : mesh.region.at("core"))
    in_core[cell] = true;
  for (const int cell : all_cells(mesh))
    for (std::size_t i = 0; i < 3; ++i) {
      const double r = radius(corners(mesh, cell)[i]);
      EXPECT_TRUE(in_core[cell] ? r <= 0.6 + 1e-15 : r >= 0.6 - 1e-15) << cell;
    }
  double polygon = 0;
  for (const auto &[edge, neighbours] : cells_of_edges(mesh)) {
    if (neighbours.size() != 2 || in_core[neighbours[0]] == in_core[neighbours[1]]) continue;
    const Point &x = mesh.points[edge.first], &y = mesh.points[edge.second];
    EXPECT_NEAR(radius(x), 0.6, 1e-15);
    EXPECT_NEAR(radius(y), 0.6, 1e-15);
    polygon += 0.5 * std::abs(x[0] * y[1] - x[1] * y[0]);
  }
  EXPECT_NEAR(area(mesh, mesh.region.at("core")), polygon, 1e-13);
  EXPECT_GT(polygon, 0.98 * 0.18 * pi);
  EXPECT_LT(polygon, 0.18 * pi);
}

TEST_P(HalfDisc, IsTheSameEveryTime) {
  const SerialMesh again = half_disc(GetParam());
  EXPECT_EQ(again.points, mesh.points);
  EXPECT_EQ(again.cells, mesh.cells);
  EXPECT_EQ(again.region, mesh.region);
  EXPECT_EQ(again.boundary, mesh.boundary);
}

TEST(HalfDiscCounts, NodesAndUnknownsOfDegreeTwo) {
  const SerialMesh coarse = half_disc(), fine = half_disc(316);
  EXPECT_EQ(coarse.boundary.at("contact").size(), 100u);
  EXPECT_EQ(coarse.points.size(), 787u);
  EXPECT_EQ(2 * (coarse.points.size() + cells_of_edges(coarse).size()), 5950u);
  EXPECT_EQ(fine.points.size(), 2018u);
  EXPECT_EQ(2 * (fine.points.size() + cells_of_edges(fine).size()), 15346u);
}

TEST(HalfDiscRefined, FollowsTheArc) {
  const Scene scene = half_disc_scene(0);
  SerialMesh mesh = half_disc();
  double deficit = pi / 2 - area(mesh, all_cells(mesh));
  for (int level = 1; level <= 2; ++level) {
    mesh = refined(mesh);
    snap_curves(mesh, scene);
    EXPECT_NO_THROW(check_mesh(mesh, "half disc"));
    expect_boundaries(mesh, boundaries_of_half_disc);
    EXPECT_LE(worst_aspect_ratio(mesh), 1.7);
    EXPECT_EQ(nodes_of(mesh, "contact").size(), at((100 << level) + 1));
    const double finer = pi / 2 - area(mesh, all_cells(mesh));
    EXPECT_NEAR(deficit / finer, 4, 0.05);
    deficit = finer;
  }
}

/// What the area of the core, a polygon, lacks to that of the half disc.
double core_deficit(const SerialMesh &mesh) {
  return 0.18 * pi - area(mesh, mesh.region.at("core"));
}

TEST(HalfDiscRefined, FollowsTheRimOfTheCore) {
  const Scene scene = half_disc_scene(0);
  SerialMesh mesh = half_disc();
  for (int level = 1; level <= 2; ++level) {
    const double coarser = core_deficit(mesh);
    mesh = refined(mesh);
    snap_curves(mesh, scene);
    EXPECT_NEAR(coarser / core_deficit(mesh), 4, 0.05);
  }
}

TEST(HalfDiscRefined, TheCoreKeepsTheAreaOfTheDisc) {
  const Scene scene = half_disc_scene(0);
  SerialMesh mesh = half_disc();
  for (int level = 0; level <= 2; ++level) {
    SerialMesh balanced = mesh;
    balance_inclusion(balanced, scene);
    EXPECT_NO_THROW(check_mesh(balanced, "half disc"));
    expect_boundaries(balanced, boundaries_of_half_disc);
    EXPECT_EQ(points_of(balanced, "arc"), points_of(mesh, "arc"));
    const std::vector<int> images = mirror_images(balanced);
    EXPECT_EQ(std::count(images.begin(), images.end(), -1), 0);
    // Second order in the edges becomes fourth: they are 0.1 long, a sixth of the radius.
    EXPECT_LT(std::abs(core_deficit(balanced)), 2e-2 / std::pow(4, level) * core_deficit(mesh));
    mesh = refined(mesh);
    snap_curves(mesh, scene);
  }
}

TEST(HalfDiscRefined, MakesTheBalancedMesh) {
  const Scene scene = half_disc_scene(0);
  SerialMesh mesh = refined(half_disc());
  snap_curves(mesh, scene);
  balance_inclusion(mesh, scene);
  EXPECT_EQ(make_mesh(PETSC_COMM_WORLD, scene, {"", 1}).fingerprint, fingerprint_of(mesh));
}

TEST(HalfDiscErrors, TheNumberOfEdgesIsEvenAndAtLeastEight) {
  for (const int edges : {-100, -1, 0, 2, 6, 9, 101}) {
    try {
      (void)half_disc(edges);
      ADD_FAILURE() << edges << " edges passed";
    } catch (const Error &error) {
      EXPECT_EQ(error.status(), Status::bad_input);
      const std::string message = error.what();
      EXPECT_NE(message.find(std::to_string(edges) + " contact edges"), std::string::npos);
      EXPECT_NE(message.find("even and at least 8"), std::string::npos) << message;
    }
  }
}

TEST(HalfDiscErrors, ARecipeCannotChooseANumberThatIsFixed) {
  Scene scene = one_block_scene();
  scene.mesh.edges = 8;
  try {
    (void)make_mesh(PETSC_COMM_WORLD, scene, {});
    ADD_FAILURE() << "8 edges passed";
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::bad_input);
    const std::string message = error.what();
    EXPECT_NE(message.find("'one_block' is fixed"), std::string::npos) << message;
  }
  EXPECT_THROW((void)make_mesh(PETSC_COMM_WORLD, half_disc_scene(-20), {}), Error);
}

TEST(OneBlock, FillsTheBlockWithMirroredSpacing) {
  const SerialMesh mesh = one_block();
  EXPECT_NO_THROW(check_mesh(mesh, "block"));
  EXPECT_EQ(mesh.points.size(), 54u);
  EXPECT_EQ(mesh.cells.size(), 80u);
  EXPECT_TRUE(mesh.region.empty());
  EXPECT_NEAR(area(mesh, all_cells(mesh)), 0.5, 1e-15);
  EXPECT_LE(worst_aspect_ratio(mesh), 1.9);
  expect_boundaries(mesh, boundaries_of_block);
  expect_boundaries(refined(mesh), boundaries_of_block);
  std::vector<int> images;
  for (const Point &x : mesh.points) {
    const auto image = std::find_if(mesh.points.begin(), mesh.points.end(), [&](const Point &y) {
      return length({1 - x[0], x[1], 0}, y) < 1e-15;
    });
    ASSERT_NE(image, mesh.points.end());
    images.push_back(static_cast<int>(image - mesh.points.begin()));
  }
  std::vector<int> same;
  for (const int image : images)
    same.push_back(images[image]);
  EXPECT_EQ(vertex_sets(mesh.cells, 3, images), vertex_sets(mesh.cells, 3, same));
}

TEST(OneBlock, ContactEdgesHaveFourLengths) {
  const std::vector<Point> contact = points_of(one_block(), "contact");
  ASSERT_EQ(contact.size(), 9u);
  std::vector<double> lengths;
  for (std::size_t i = 1; i <= 4; ++i)
    lengths.push_back(contact[i][0] - contact[i - 1][0]);
  std::sort(lengths.begin(), lengths.end());
  for (std::size_t i = 1; i < 4; ++i)
    EXPECT_GT(lengths[i], 1.05 * lengths[i - 1]);
}

/// Totals and fingerprint are those of one process, and the labelled cells and vertices as many.
void expect_same_on_all_ranks(const Scene &scene, int refine) {
  const Mesh mesh = make_mesh(PETSC_COMM_WORLD, scene, {"", refine});
  const Mesh alone = make_mesh(PETSC_COMM_SELF, scene, {"", refine});
  EXPECT_EQ(mesh.total_vertices, alone.total_vertices);
  EXPECT_EQ(mesh.total_cells, alone.total_cells);
  EXPECT_EQ(mesh.fingerprint, alone.fingerprint);
  std::vector<int> counts, expected;
  for (const auto &[name, marked] : mesh.region) {
    counts.push_back(static_cast<int>(std::count(marked.begin(), marked.end(), true)));
    const auto &whole = alone.region.at(name);
    expected.push_back(static_cast<int>(std::count(whole.begin(), whole.end(), true)));
  }
  for (const auto &[name, marked] : mesh.boundary) {
    counts.push_back(0);
    for (std::size_t v = 0; v < marked.size(); ++v)
      counts.back() += marked[v] && mesh.owned_node[v] ? 1 : 0;
    const auto &whole = alone.boundary.at(name);
    expected.push_back(static_cast<int>(std::count(whole.begin(), whole.end(), true)));
  }
  MPI_Allreduce(MPI_IN_PLACE, counts.data(), static_cast<int>(counts.size()), MPI_INT, MPI_SUM,
                PETSC_COMM_WORLD);
  EXPECT_EQ(counts, expected);
}

TEST(OneBody, IsTheSameOnAllRanks) {
  for (const int refine : {0, 1}) {
    expect_same_on_all_ranks(half_disc_scene(0), refine);
    expect_same_on_all_ranks(half_disc_scene(20), refine);
    expect_same_on_all_ranks(one_block_scene(), refine);
  }
}

TEST(OneBody, TheRecipeChoosesTheEdges) {
  for (const auto &[edges, made] : std::map<int, int>{{0, 100}, {316, 316}}) {
    const Mesh mesh = make_mesh(PETSC_COMM_WORLD, half_disc_scene(edges), {});
    SerialMesh serial = half_disc(made);
    balance_inclusion(serial, half_disc_scene(edges));
    EXPECT_EQ(at(mesh.total_vertices), serial.points.size());
    EXPECT_EQ(at(mesh.total_cells), serial.cells.size());
    EXPECT_EQ(mesh.fingerprint, fingerprint_of(serial));
  }
}

} // namespace
} // namespace rbvi::half_disc_test
