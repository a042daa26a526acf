// The built-in meshes of two bodies: quarter discs in contact, and the blocks of the patch test.
#include "rbvi/core/error.hpp"
#include "triangles.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace rbvi::two_bodies_test {
namespace {

constexpr double quarter = std::numbers::pi / 4; ///< contact angle, and area of a quarter disc
constexpr int nodes = 3065, cells = 5507;        ///< of one quarter disc

/// Onto the circle of the body.
Point onto_circle(const Point &x) {
  const double centre = x[1] > 0 ? 1.5 : -1.5;
  const double radius = std::hypot(x[0], x[1] - centre);
  return {x[0] / radius, centre + (x[1] - centre) / radius, 0};
}

double distance_to_circle(const Point &x) {
  return std::abs(std::hypot(x[0], std::abs(x[1]) - 1.5) - 1);
}

Scene two_discs_scene() {
  Scene scene;
  scene.name = "two_discs";
  scene.components = 2;
  scene.mesh = {
      "two_quarter_discs", {"upper", "lower"}, {"axis", "top", "bottom", "slave", "master", "arc"}};
  scene.curves = {{"arc", onto_circle}};
  return scene;
}

Scene two_blocks_scene() {
  Scene scene;
  scene.name = "two_blocks";
  scene.components = 2;
  scene.mesh = {"two_blocks", {"upper", "lower"}, {"sides", "top", "bottom", "slave", "master"}};
  return scene;
}

SerialMesh refined_discs(int levels) {
  const Scene scene = two_discs_scene();
  SerialMesh mesh = two_quarter_discs();
  for (int level = 0; level < levels; ++level) {
    mesh = refined(mesh);
    snap_curves(mesh, scene);
  }
  return mesh;
}

std::multiset<std::string> boundaries_of_discs(const Point &x, const Point &y) {
  const bool upper = x[1] > 0;
  if (x[0] == 0 && y[0] == 0) return {"axis"};
  if (std::abs(x[1]) == 1.5 && x[1] == y[1]) return {upper ? "top" : "bottom"};
  if (std::max(distance_to_circle(x), distance_to_circle(y)) > 1e-14) return {};
  const double lowest = 1.5 - std::cos(quarter) + 1e-14;
  if (std::max(std::abs(x[1]), std::abs(y[1])) > lowest) return {"arc"};
  return {"arc", upper ? "slave" : "master"};
}

std::multiset<std::string> boundaries_of_blocks(const Point &x, const Point &y) {
  if (x[0] == y[0] && (x[0] == 0 || x[0] == 1)) return {"sides"};
  if (x[1] != y[1]) return {};
  const std::map<double, std::string> names{
      {0.75, "top"}, {0.25, "slave"}, {-0.25, "master"}, {-0.75, "bottom"}};
  return {names.at(x[1])};
}

TEST(TwoQuarterDiscs, HasTheCountsOfItsRings) {
  const SerialMesh mesh = two_quarter_discs();
  EXPECT_NO_THROW(check_mesh(mesh, "discs"));
  EXPECT_EQ(mesh.points.size(), at(2 * nodes));
  EXPECT_EQ(mesh.cells.size(), at(2 * cells));
  for (const std::string region : {"upper", "lower"}) {
    EXPECT_EQ(mesh.region.at(region).size(), at(cells));
    std::set<int> own;
    for (const int c : mesh.region.at(region))
      own.insert(mesh.cells[c].begin(), mesh.cells[c].begin() + 3);
    EXPECT_EQ(own.size(), at(nodes));
    for (const int v : own)
      EXPECT_EQ(mesh.points[v][1] > 0, region == "upper");
  }
}

TEST(TwoQuarterDiscs, ContactArcsHaveEqualEdgesFromTheAxisOn) {
  const SerialMesh mesh = two_quarter_discs();
  for (const std::string name : {"slave", "master"}) {
    const std::vector<int> arc = nodes_of(mesh, name);
    ASSERT_EQ(arc.size(), 561u);
    EXPECT_EQ(mesh.boundary.at(name).size(), 560u);
    EXPECT_EQ(mesh.points[arc.front()], (Point{0, name == "slave" ? 0.5 : -0.5, 0}));
    EXPECT_NEAR(mesh.points[arc.back()][0], std::sin(quarter), 1e-15);
    for (std::size_t i = 0; i < arc.size(); ++i) {
      const Point &x = mesh.points[arc[i]];
      EXPECT_LE(distance_to_circle(x), 3e-16);
      if (i == 0) continue;
      const Point &y = mesh.points[arc[i - 1]];
      EXPECT_GT(x[0], y[0]);
      EXPECT_NEAR(length(x, y), 2 * std::sin(quarter / 1120), 1e-15);
    }
  }
}

TEST(TwoQuarterDiscs, BoundariesAreCompleteAndExact) {
  const SerialMesh mesh = two_quarter_discs();
  expect_boundaries(mesh, boundaries_of_discs);
  for (const int v : nodes_of(mesh, "arc"))
    EXPECT_LE(distance_to_circle(mesh.points[v]), 5e-16);
  EXPECT_EQ(mesh.points[nodes_of(mesh, "top").back()], (Point{1, 1.5, 0}));
  EXPECT_EQ(mesh.points[nodes_of(mesh, "bottom").front()], (Point{0, -1.5, 0}));
}

TEST(TwoQuarterDiscs, TheLowerBodyIsTheImageOfTheUpperOne) {
  const SerialMesh mesh = two_quarter_discs();
  for (std::size_t v = 0; v < nodes; ++v) {
    const Point &x = mesh.points[v];
    EXPECT_EQ(mesh.points[nodes + v], (Point{x[0], -x[1], 0}));
  }
  for (std::size_t c = 0; c < cells; ++c) {
    auto upper = mesh.cells[c], lower = mesh.cells[cells + c];
    std::sort(upper.begin(), upper.begin() + 3);
    std::sort(lower.begin(), lower.begin() + 3);
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(lower[i], upper[i] + nodes);
  }
}

TEST(TwoQuarterDiscs, CellsAreWellShapedAndGrowSmoothly) {
  const SerialMesh mesh = two_quarter_discs();
  EXPECT_LE(worst_aspect_ratio(mesh), 1.65);
  EXPECT_LE(largest_jump(mesh), 1.8);
  const auto [shortest, longest] = range_of_edges(mesh);
  EXPECT_GT(shortest, 0.0012);
  EXPECT_LT(longest, 0.16);
}

TEST(TwoQuarterDiscs, RefinementFollowsTheCircles) {
  std::array<double, 3> error{};
  for (int level = 0; level < 3; ++level) {
    const SerialMesh mesh = refined_discs(level);
    EXPECT_NO_THROW(check_mesh(mesh, "discs"));
    expect_boundaries(mesh, boundaries_of_discs);
    EXPECT_LE(worst_aspect_ratio(mesh), 1.7);
    for (const std::string name : {"slave", "master"})
      EXPECT_EQ(nodes_of(mesh, name).size(), at((560 << level) + 1));
    for (const int v : nodes_of(mesh, "arc"))
      EXPECT_LE(distance_to_circle(mesh.points[v]), 1e-14);
    for (const int v : nodes_of(mesh, "axis"))
      EXPECT_EQ(mesh.points[v][0], 0);
    error[level] = quarter - area(mesh, mesh.region.at("upper"));
    EXPECT_NEAR(area(mesh, mesh.region.at("lower")), area(mesh, mesh.region.at("upper")), 1e-14);
  }
  EXPECT_LT(error[0], 1e-3);
  EXPECT_NEAR(error[0] / error[1], 4, 0.05);
  EXPECT_NEAR(error[1] / error[2], 4, 0.05);
}

TEST(TwoQuarterDiscs, WithoutACurvedBoundaryNothingIsMoved) {
  Scene scene = two_discs_scene();
  scene.curves.clear();
  const SerialMesh fine = refined(two_quarter_discs());
  SerialMesh mesh = fine;
  snap_curves(mesh, scene);
  EXPECT_EQ(mesh.points, fine.points);
}

class TwoGradedQuarterDiscs : public testing::TestWithParam<int> {
protected:
  const SerialMesh mesh = two_graded_quarter_discs(GetParam());
};
INSTANTIATE_TEST_SUITE_P(Edges, TwoGradedQuarterDiscs, testing::Values(8, 21, 70, 140, 280));

TEST_P(TwoGradedQuarterDiscs, AreWellShapedAndFillThePolygons) {
  EXPECT_NO_THROW(check_mesh(mesh, "discs"));
  EXPECT_LE(worst_aspect_ratio(mesh), GetParam() == 140 ? 1.56 : 2.2);
  EXPECT_LE(largest_jump(mesh), 2.5);
  EXPECT_LT(range_of_edges(mesh).second, 0.22);
  for (const std::string body : {"upper", "lower"}) {
    EXPECT_LT(area(mesh, mesh.region.at(body)), quarter);
    EXPECT_GT(area(mesh, mesh.region.at(body)), 0.99 * quarter);
    for (const int cell : mesh.region.at(body))
      EXPECT_EQ(corners(mesh, cell)[0][1] > 0, body == "upper");
  }
  EXPECT_EQ(mesh.region.at("upper").size() + mesh.region.at("lower").size(), mesh.cells.size());
}

TEST_P(TwoGradedQuarterDiscs, BoundariesAreCompleteAndExact) {
  expect_boundaries(mesh, boundaries_of_discs);
  for (const int v : nodes_of(mesh, "arc"))
    EXPECT_LE(distance_to_circle(mesh.points[v]), 5e-16);
  for (const std::string name : {"slave", "master"}) {
    const std::vector<int> arc = nodes_of(mesh, name);
    ASSERT_EQ(arc.size(), at(GetParam() + 1));
    EXPECT_EQ(mesh.points[arc.front()], (Point{0, name == "slave" ? 0.5 : -0.5, 0}));
    EXPECT_NEAR(mesh.points[arc.back()][0], std::sin(quarter), 1e-15);
    for (std::size_t i = 1; i < arc.size(); ++i)
      EXPECT_NEAR(length(mesh.points[arc[i]], mesh.points[arc[i - 1]]),
                  2 * std::sin(quarter / (2 * GetParam())), 1e-14);
  }
}

TEST_P(TwoGradedQuarterDiscs, AreTheSameEveryTime) {
  const SerialMesh again = two_graded_quarter_discs(GetParam());
  EXPECT_EQ(again.points, mesh.points);
  EXPECT_EQ(again.cells, mesh.cells);
  EXPECT_EQ(again.boundary, mesh.boundary);
}

TEST(TwoGradedQuarterDiscsCounts, DegreeTwoHasTheNodesThatTheFixedMeshHasOfDegreeOne) {
  const SerialMesh mesh = two_graded_quarter_discs(140);
  EXPECT_EQ(mesh.points.size() + cells_of_edges(mesh).size(), 6142u);
  EXPECT_THROW((void)two_graded_quarter_discs(7), Error);
}

TEST(TwoBlocks, FillTheBlocksWithMeshesThatDoNotMatch) {
  const SerialMesh mesh = two_blocks();
  EXPECT_NO_THROW(check_mesh(mesh, "blocks"));
  EXPECT_EQ(mesh.points.size(), at(11 * 6 + 8 * 5));
  EXPECT_EQ(mesh.cells.size(), at(2 * (10 * 5 + 7 * 4)));
  EXPECT_NEAR(area(mesh, mesh.region.at("upper")), 0.5, 1e-15);
  EXPECT_NEAR(area(mesh, mesh.region.at("lower")), 0.5, 1e-15);
  EXPECT_LE(worst_aspect_ratio(mesh), 1.9);
  expect_boundaries(mesh, boundaries_of_blocks);
  expect_boundaries(refined(mesh), boundaries_of_blocks);
  const std::vector<int> slave = nodes_of(mesh, "slave"), master = nodes_of(mesh, "master");
  ASSERT_EQ(slave.size(), 11u);
  ASSERT_EQ(master.size(), 8u);
  for (std::size_t i = 1; i < 10; ++i)
    for (std::size_t j = 1; j < 7; ++j)
      EXPECT_GT(std::abs(mesh.points[slave[i]][0] - mesh.points[master[j]][0]), 1e-4);
  double shortest = 1, longest = 0;
  for (std::size_t i = 1; i < slave.size(); ++i) {
    const double edge = mesh.points[slave[i]][0] - mesh.points[slave[i - 1]][0];
    shortest = std::min(shortest, edge);
    longest = std::max(longest, edge);
  }
  EXPECT_GT(longest, 1.5 * shortest);
}

/// The mesh on all ranks is, piece by piece, the mesh that one process makes.
void expect_same_on_all_ranks(const Scene &scene, int refine) {
  const Mesh mesh = make_mesh(PETSC_COMM_WORLD, scene, {"", refine});
  const Mesh alone = make_mesh(PETSC_COMM_SELF, scene, {"", refine});
  EXPECT_EQ(mesh.fingerprint, alone.fingerprint);
  std::vector<int> owners(alone.total_vertices + alone.total_cells, 0);
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const PetscInt natural = mesh.natural_node[v];
    EXPECT_EQ(mesh.points[v], alone.points.at(natural));
    owners[natural] += mesh.owned_node[v] ? 1 : 0;
    for (const auto &[name, marked] : alone.boundary)
      EXPECT_EQ(mesh.boundary.at(name).at(v), marked[natural]) << name;
  }
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const PetscInt natural = mesh.natural_cell[c];
    ++owners[alone.total_vertices + natural];
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(mesh.natural_node.at(mesh.cells[c][i]), alone.cells.at(natural)[i]);
    for (const auto &[name, marked] : alone.region)
      EXPECT_EQ(mesh.region.at(name).at(c), marked[natural]) << name;
  }
  MPI_Allreduce(MPI_IN_PLACE, owners.data(), static_cast<int>(owners.size()), MPI_INT, MPI_SUM,
                PETSC_COMM_WORLD);
  EXPECT_EQ(owners, std::vector<int>(owners.size(), 1));
  const SerialMesh serial =
      scene.mesh.generator == "two_blocks" ? two_blocks() : two_quarter_discs();
  for (std::size_t v = 0; refine == 0 && v < serial.points.size(); ++v)
    EXPECT_EQ(alone.points.at(v), serial.points[v]);
}

class TwoBodies : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Refinements, TwoBodies, testing::Values(0, 1));

TEST_P(TwoBodies, QuarterDiscsAreTheSameOnAllRanks) {
  expect_same_on_all_ranks(two_discs_scene(), GetParam());
}

TEST_P(TwoBodies, BlocksAreTheSameOnAllRanks) {
  expect_same_on_all_ranks(two_blocks_scene(), GetParam());
}

TEST(TwoBodiesCounts, MakeMeshRefinesAndSnaps) {
  const Mesh mesh = make_mesh(PETSC_COMM_WORLD, two_discs_scene(), {"", 1});
  EXPECT_EQ(mesh.total_cells, 4 * 2 * cells);
  EXPECT_EQ(mesh.total_vertices, 2 * nodes + 2 * (nodes + cells - 1)); // one more per edge
  int slave = 0;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    if (mesh.boundary.at("slave")[v] && mesh.owned_node[v]) ++slave;
    EXPECT_TRUE(!mesh.boundary.at("arc")[v] || distance_to_circle(mesh.points[v]) <= 1e-14);
  }
  MPI_Allreduce(MPI_IN_PLACE, &slave, 1, MPI_INT, MPI_SUM, PETSC_COMM_WORLD);
  EXPECT_EQ(slave, 1121);
}

TEST(TwoBodiesLabels, ASceneNamesThoseThatItNeeds) {
  Scene scene = two_discs_scene();
  scene.mesh = {"two_quarter_discs", {"upper"}, {"top", "arc"}};
  const Mesh mesh = make_mesh(PETSC_COMM_WORLD, scene, {"", 1});
  EXPECT_EQ(mesh.region.size(), 1u);
  EXPECT_EQ(mesh.boundary.size(), 2u);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    EXPECT_EQ(mesh.region.at("upper")[c], mesh.points[mesh.cells[c][0]][1] > 0);
}

TEST(TwoBodiesErrors, AnUnknownGeneratorIsAnsweredByThoseThatExist) {
  Scene scene = two_discs_scene();
  scene.mesh.generator = "three_quarter_discs";
  try {
    (void)make_mesh(PETSC_COMM_WORLD, scene, {});
    FAIL() << "an unknown generator passed";
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::bad_input);
    const std::string message = error.what();
    for (const std::string name :
         {"three_quarter_discs", "square_with_disc", "two_quarter_discs",
          "two_graded_quarter_discs", "two_blocks", "half_disc", "one_block"})
      EXPECT_NE(message.find(name), std::string::npos) << message;
  }
}

} // namespace
} // namespace rbvi::two_bodies_test
