// Every test compares the mesh spread over all ranks with the same mesh made by one process.
#include "rbvi/core/error.hpp"
#include "rbvi/element/facets.hpp"
#include "tests/catalogue.hpp"
#include "triangles.hpp"

#include <cmath>

namespace rbvi::make_mesh_test {
namespace {

template <class T> std::vector<T> summed(std::vector<T> values, MPI_Datatype type) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), type, MPI_SUM,
                PETSC_COMM_WORLD);
  return values;
}

double area(const Mesh &mesh, const std::string &region) {
  double sum = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (!region.empty() && !mesh.region.at(region)[c]) continue;
    std::array<Point, 4> corners{};
    for (std::size_t i = 0; i < 3; ++i)
      corners[i] = mesh.points[mesh.cells[c][i]];
    sum += simplex(2, corners).volume;
  }
  return summed(std::vector<double>{sum}, MPI_DOUBLE)[0];
}

class MakeMesh : public testing::TestWithParam<int> {
protected:
  const Scene scene = make_scene("membrane_obstacle");
  const Mesh mesh = make_mesh(PETSC_COMM_WORLD, scene, {"", GetParam()});
  const Mesh alone = make_mesh(PETSC_COMM_SELF, scene, {"", GetParam()});
};
INSTANTIATE_TEST_SUITE_P(Refinements, MakeMesh, testing::Values(0, 1));

TEST_P(MakeMesh, TotalsAndFingerprintDoNotDependOnRanks) {
  EXPECT_EQ(mesh.total_vertices, alone.total_vertices);
  EXPECT_EQ(mesh.total_cells, alone.total_cells);
  EXPECT_EQ(mesh.fingerprint, alone.fingerprint);
  EXPECT_EQ(alone.points.size(), at(alone.total_vertices));
  EXPECT_EQ(alone.cells.size(), at(alone.total_cells));
}

/// Without making it: of every scene, of either degree.
TEST(CountNodes, IsThatOfTheMesh) {
  for (const SceneEntry &entry : catalogue())
    for (const int refine : {0, 1}) {
      Scene scene = make_scene(entry.name);
      for (scene.degree = 1; scene.degree <= 2; ++scene.degree)
        EXPECT_EQ(count_nodes(PETSC_COMM_WORLD, scene, {"", refine}),
                  make_mesh(PETSC_COMM_WORLD, scene, {"", refine}).total_nodes)
            << entry.name << " refined " << refine << " times, degree " << scene.degree;
    }
}

TEST_P(MakeMesh, NaturalNumbersAreTheOrderOfOneProcess) {
  for (std::size_t v = 0; v < alone.points.size(); ++v)
    EXPECT_EQ(alone.natural_node[v], static_cast<PetscInt>(v));
  for (std::size_t c = 0; c < alone.cells.size(); ++c)
    EXPECT_EQ(alone.natural_cell[c], static_cast<PetscInt>(c));
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    EXPECT_EQ(mesh.points[v], alone.points.at(mesh.natural_node[v]));
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(mesh.natural_node.at(mesh.cells[c][i]), alone.cells.at(mesh.natural_cell[c])[i]);
}

TEST_P(MakeMesh, EveryCellAndEveryVertexHasOneOwner) {
  std::vector<int> vertex(mesh.total_vertices, 0), cell(mesh.total_cells, 0);
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    if (mesh.owned_node[v]) ++vertex[mesh.natural_node[v]];
  for (const PetscInt natural : mesh.natural_cell)
    ++cell[natural];
  EXPECT_EQ(summed(vertex, MPI_INT), std::vector<int>(vertex.size(), 1));
  EXPECT_EQ(summed(cell, MPI_INT), std::vector<int>(cell.size(), 1));
}

TEST_P(MakeMesh, LabelsTravelWithTheMesh) {
  const auto &disc = mesh.region.at("obstacle"), &whole_disc = alone.region.at("obstacle");
  ASSERT_EQ(disc.size(), mesh.cells.size());
  for (std::size_t c = 0; c < disc.size(); ++c)
    EXPECT_EQ(disc[c], whole_disc[mesh.natural_cell[c]]);
  const auto &rim = mesh.boundary.at("boundary"), &whole_rim = alone.boundary.at("boundary");
  ASSERT_EQ(rim.size(), mesh.points.size());
  for (std::size_t v = 0; v < rim.size(); ++v) {
    EXPECT_EQ(rim[v], whole_rim[mesh.natural_node[v]]);
    const Point &x = mesh.points[v];
    EXPECT_EQ(rim[v], std::max(std::abs(x[0]), std::abs(x[1])) > 0.5 - 1e-12);
  }
}

/// Per natural cell: how many of its facets are on a boundary of any name, over all ranks.
std::vector<int> facets_per_cell(const Mesh &mesh, const std::string &boundary) {
  std::vector<int> count(mesh.total_cells, 0);
  for (const auto &[cell, facet] : mesh.facets.at(boundary)) {
    ++count[mesh.natural_cell.at(cell)];
    for (const int i : facet_nodes(mesh.dim, 1, facet))
      EXPECT_TRUE(mesh.boundary.at(boundary)[mesh.cells[cell][i]]) << boundary;
  }
  return count;
}

/// Of every scene and either degree: each facet is one rank's, with its nodes.
TEST(MakeMeshFacets, AreThoseOfOneProcess) {
  for (const SceneEntry &entry : catalogue()) {
    Scene scene = make_scene(entry.name);
    std::map<std::string, std::vector<int>> of_degree_one;
    for (scene.degree = 1; scene.degree <= 2; ++scene.degree) {
      const Mesh mesh = make_mesh(PETSC_COMM_WORLD, scene, {});
      const Mesh alone = make_mesh(PETSC_COMM_SELF, scene, {});
      for (const std::string &name : scene.mesh.boundaries) {
        const std::vector<int> whole = facets_per_cell(alone, name);
        EXPECT_EQ(summed(facets_per_cell(mesh, name), MPI_INT), whole) << entry.name << " " << name;
        EXPECT_EQ(of_degree_one.emplace(name, whole).first->second, whole) << entry.name;
        for (std::size_t v = 0; v < mesh.points.size(); ++v)
          EXPECT_EQ(mesh.boundary.at(name)[v], alone.boundary.at(name)[mesh.natural_node[v]]);
      }
    }
  }
}

TEST_P(MakeMesh, AreasAreThoseOfSquareAndPolygon) {
  const int sides = 60 << GetParam();
  EXPECT_NEAR(area(mesh, ""), 1, 1e-12);
  EXPECT_NEAR(area(mesh, "obstacle") / polygon_area(sides, 0.2), 1, 1e-12);
}

TEST_P(MakeMesh, InterfaceVerticesAreOnTheCircle) {
  std::vector<int> in_disc(mesh.total_vertices, 0), in_rest(in_disc);
  for (std::size_t c = 0; c < alone.cells.size(); ++c)
    for (std::size_t i = 0; i < 3; ++i)
      (alone.region.at("obstacle")[c] ? in_disc : in_rest)[alone.cells[c][i]] = 1;
  int interface = 0, disc = 0;
  for (std::size_t v = 0; v < alone.points.size(); ++v) {
    disc += in_disc[v];
    if (in_disc[v] == 0 || in_rest[v] == 0) continue;
    ++interface;
    EXPECT_NEAR(std::hypot(alone.points[v][0], alone.points[v][1]), 0.2, 1e-14);
  }
  EXPECT_EQ(interface, 60 << GetParam());
  EXPECT_EQ(disc, GetParam() == 0 ? 631 : 631 + (631 + 1200 - 1)); // vertices and edges (Euler)
}

TEST_P(MakeMesh, DmPointsAreTheVerticesOfTheDm) {
  PetscInt begin = 0, end = 0;
  ASSERT_EQ(DMPlexGetDepthStratum(mesh.dm.get(), 0, &begin, &end), 0);
  ASSERT_EQ(mesh.dm_point.size(), at(end - begin));
  for (std::size_t v = 0; v < mesh.dm_point.size(); ++v)
    EXPECT_EQ(mesh.dm_point[v], begin + static_cast<PetscInt>(v));
}

TEST(MakeMeshCounts, ARefinementAddsOneVertexPerEdge) {
  const Scene scene = make_scene("membrane_obstacle");
  const Mesh fine = make_mesh(PETSC_COMM_WORLD, scene, {"", 1});
  EXPECT_EQ(fine.total_vertices, 3399 + (3399 + 6620 - 1));
  EXPECT_EQ(fine.total_cells, 4 * 6620);
  EXPECT_NE(fine.fingerprint, make_mesh(PETSC_COMM_WORLD, scene, {}).fingerprint);
}

/// The same, bit by bit, whether it is made or taken from a finer one; also where the rim of an
/// inclusion is balanced after the refinements.
TEST(MakeMeshLevels, AFinerMeshHasTheCoarserOnes) {
  for (const std::string name : {"membrane_obstacle", "rigid_disk", "two_disks"}) {
    Scene scene = make_scene(name);
    scene.degree = 2;
    const Mesh fine = make_mesh(PETSC_COMM_WORLD, scene, {"", 2});
    for (const int refine : {0, 1}) {
      const Mesh made = make_mesh(PETSC_COMM_WORLD, scene, {"", refine});
      const Mesh taken = make_mesh(PETSC_COMM_WORLD, scene, {"", refine, fine.levels});
      EXPECT_EQ(taken.fingerprint, made.fingerprint) << name;
      EXPECT_EQ(taken.points, made.points) << name;
      EXPECT_EQ(taken.cells, made.cells) << name;
      EXPECT_EQ(taken.boundary, made.boundary) << name;
    }
  }
}

TEST(MakeMeshCounts, EveryRankHasItsShare) {
  const Mesh mesh = make_mesh(PETSC_COMM_WORLD, make_scene("membrane_obstacle"), {});
  int ranks = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  EXPECT_NEAR(static_cast<double>(mesh.cells.size()), 6620.0 / ranks, 0.05 * 6620 / ranks);
}

TEST(MakeMeshErrors, WrongRequestsAreErrorsOnEveryRank) {
  Scene scene = make_scene("membrane_obstacle");
  EXPECT_THROW(make_mesh(PETSC_COMM_WORLD, scene, {"", -1}), Error);
  scene.mesh.generator = "moebius_strip";
  try {
    (void)make_mesh(PETSC_COMM_WORLD, scene, {});
    FAIL() << "an unknown generator passed";
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::bad_input);
    EXPECT_NE(std::string(error.what()).find("moebius_strip"), std::string::npos);
  }
}

} // namespace
} // namespace rbvi::make_mesh_test
