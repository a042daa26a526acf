#include "rbvi/core/error.hpp"
#include "tests/catalogue.hpp"
#include "triangles.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace rbvi::serial_mesh_test {
namespace {

TEST(SquareWithDisc, HasTheCountsOfItsRings) {
  const SerialMesh mesh = square_with_disc();
  EXPECT_EQ(mesh.points.size(), 3573u);
  // Euler's formula for a disc, every boundary vertex being on one boundary edge too.
  const std::size_t boundary = mesh.boundary.at("boundary").size();
  EXPECT_EQ(boundary, 200u);
  EXPECT_EQ(mesh.cells.size(), 2 * mesh.points.size() - 2 - boundary);
  std::set<int> disc;
  for (const int cell : mesh.region.at("obstacle"))
    disc.insert(mesh.cells[cell].begin(), mesh.cells[cell].begin() + 3);
  EXPECT_EQ(disc.size(), 469u);
  const auto inside = std::count_if(mesh.points.begin(), mesh.points.end(), [](const Point &x) {
    return std::hypot(x[0], x[1]) <= 0.2 * (1 + 1e-14);
  });
  EXPECT_EQ(inside, 469);
}

TEST(SquareWithDisc, FillsSquareAndPolygon) {
  const SerialMesh mesh = square_with_disc();
  EXPECT_NO_THROW(check_mesh(mesh, "square"));
  EXPECT_NEAR(area(mesh, all_cells(mesh)), 1, 1e-13);
  EXPECT_NEAR(area(mesh, mesh.region.at("obstacle")) / polygon_area(72, 0.2), 1, 1e-13);
  double perimeter = 0;
  for (const auto &edge : mesh.boundary.at("boundary")) {
    const Point &x = mesh.points[edge[0]], &y = mesh.points[edge[1]];
    EXPECT_NEAR(std::max(std::abs(x[0]), std::abs(x[1])), 0.5, 1e-15);
    perimeter += length(x, y);
  }
  EXPECT_NEAR(perimeter, 4, 1e-13);
}

// The lattice that keeps the disc's rings from being concentric with the contact set costs a little
// shape: measured 1.543 and edges from 0.0127, against 1.434 and 0.015 with circular rings.
TEST(SquareWithDisc, IsWellShapedAndNearlyUniform) {
  const SerialMesh mesh = square_with_disc();
  EXPECT_LE(worst_aspect_ratio(mesh), 1.55);
  const auto [shortest, longest] = range_of_edges(mesh);
  EXPECT_GT(shortest, 0.0126);
  EXPECT_LT(longest, 0.0285);
}

TEST(SquareWithDisc, TurnsIntoItselfByAQuarter) {
  const SerialMesh mesh = square_with_disc();
  for (const Point &x : mesh.points) {
    const bool found = std::any_of(mesh.points.begin(), mesh.points.end(), [&](const Point &y) {
      return std::abs(y[0] + x[1]) < 1e-14 && std::abs(y[1] - x[0]) < 1e-14;
    });
    // Inside the disc only every second ring (6 k nodes) has the symmetry of the square.
    EXPECT_TRUE(found || std::hypot(x[0], x[1]) < 0.2 * (1 - 1e-12));
  }
}

// The published answers are to stay: they hang on this mesh, to the last node.
TEST(SquareWithDisc, IsThatOfThePublishedAnswers) {
  EXPECT_EQ(fingerprint_of(square_with_disc()), "941ab4dbaacc319d");
}

TEST(GradedSquareWithDisc, HasTheCountsOfItsRings) {
  const SerialMesh mesh = square_with_disc(60);
  EXPECT_EQ(mesh.points.size(), 3399u);
  EXPECT_EQ(mesh.boundary.at("boundary").size(), 176u);
  EXPECT_EQ(mesh.cells.size(), 2 * mesh.points.size() - 2 - 176);
  std::set<int> disc;
  for (const int cell : mesh.region.at("obstacle"))
    disc.insert(mesh.cells[cell].begin(), mesh.cells[cell].begin() + 3);
  // Ten rings of 6 k nodes about the centre, then five of 60.
  EXPECT_EQ(disc.size(), at(1 + 3 * 10 * 11 + 5 * 60));
  EXPECT_EQ(fingerprint_of(mesh), fingerprint_of(square_with_disc(60)));
}

TEST(GradedSquareWithDisc, FillsSquareAndPolygonInGoodShape) {
  for (const int edges : {12, 24, 36, 60, 72, 96}) {
    const SerialMesh mesh = square_with_disc(edges);
    EXPECT_NO_THROW(check_mesh(mesh, "graded"));
    EXPECT_NEAR(area(mesh, all_cells(mesh)), 1, 1e-13);
    EXPECT_NEAR(area(mesh, mesh.region.at("obstacle")) / polygon_area(edges, 0.2), 1, 1e-13);
    EXPECT_LE(worst_aspect_ratio(mesh), edges == 12 ? 1.65 : 1.6) << edges;
  }
}

TEST(GradedSquareWithDisc, IsFinestWhereTheMembraneRests) {
  const SerialMesh mesh = square_with_disc(60), published = square_with_disc();
  const auto [shortest, longest] = range_of_edges(mesh);
  EXPECT_GT(shortest, 0.0109);
  EXPECT_LT(longest, 0.0285);
  EXPECT_LT(mesh.points.size(), published.points.size());
  const auto within = [](const SerialMesh &of, double radius) {
    return std::count_if(of.points.begin(), of.points.end(),
                         [&](const Point &x) { return std::hypot(x[0], x[1]) < radius; });
  };
  EXPECT_GT(static_cast<double>(within(mesh, 0.12)),
            1.6 * static_cast<double>(within(published, 0.12)));
}

TEST(GradedSquareWithDisc, TurnsIntoItselfByAQuarterOutsideTheDisc) {
  const SerialMesh mesh = square_with_disc(60);
  for (const Point &x : mesh.points)
    EXPECT_TRUE(std::hypot(x[0], x[1]) < 0.2 * (1 - 1e-12) ||
                std::any_of(mesh.points.begin(), mesh.points.end(), [&](const Point &y) {
                  return std::abs(y[0] + x[1]) < 1e-14 && std::abs(y[1] - x[0]) < 1e-14;
                }));
}

// Measured 2.79, where the disc is small and off the centre; the published mesh has 2.60.
TEST(GradedSquareWithDisc, KeepsItsShapeInTheWholeBoxOfParameters) {
  const SerialMesh mesh = square_with_disc(60);
  for (const std::string map : {"similarity", "graded"}) {
    const Scene scene = make_scene("membrane_obstacle", {{"disc_map", map}});
    for (const double radius : {0.16, 0.24})
      for (const double x : {-0.05, 0.0, 0.05})
        for (const double y : {-0.05, 0.0, 0.05}) {
          SerialMesh mapped = mesh;
          for (Point &point : mapped.points)
            point = scene.map({radius, x, y}, point);
          EXPECT_NO_THROW(check_mesh(mapped, "mapped"));
          EXPECT_LE(worst_aspect_ratio(mapped), 2.85) << radius << ' ' << x << ' ' << y;
        }
  }
}

TEST(GradedSquareWithDisc, RefusesOtherNumbersOfEdges) {
  for (const int edges : {-12, 0, 6, 11, 18, 61})
    EXPECT_THROW((void)square_with_disc(edges), Error) << edges;
}

TEST(SquareWithDisc, TheSceneTakesTheGradedOneByVertexQuadratureAlone) {
  EXPECT_EQ(make_scene("membrane_obstacle").mesh.edges, 60);
  EXPECT_EQ(make_scene("membrane_obstacle", {{"lumped", "no"}}).mesh.edges, 0);
  for (const std::string lumped : {"yes", "no"})
    EXPECT_EQ(
        make_scene("membrane_obstacle", {{"lumped", lumped}, {"circle_edges", "24"}}).mesh.edges,
        24);
}

TEST(CheckMesh, NamesAnInvertedCell) {
  SerialMesh mesh = square_with_disc();
  std::swap(mesh.cells[17][0], mesh.cells[17][1]);
  try {
    check_mesh(mesh, "my mesh");
    FAIL() << "an inverted cell passed";
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::bad_input);
    EXPECT_NE(std::string(error.what()).find("my mesh: cell 17 "), std::string::npos)
        << error.what();
  }
}

TEST(CheckMesh, SeesAFoldEvenIfEveryCellIsTurnedUpright) {
  SerialMesh mesh = square_with_disc();
  mesh.points[0] = {0.03, 0, 0}; // the centre, moved out of the first ring
  EXPECT_THROW(check_mesh(mesh, "fold"), Error);
  orient_cells(2, mesh.points, mesh.cells);
  try {
    check_mesh(mesh, "fold");
    FAIL() << "a fold passed";
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find("same side"), std::string::npos) << error.what();
  }
}

TEST(CheckMesh, SeesADegenerateCellAtAnyScale) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    SerialMesh mesh;
    mesh.points = {{0, 0, 0}, {scale, 0, 0}, {0, scale, 0}, {scale, scale, 0}};
    mesh.cells = {{0, 1, 2, -1}, {1, 3, 2, -1}};
    EXPECT_NO_THROW(check_mesh(mesh, "two triangles"));
    mesh.points[3] = {0.5 * scale, 0.5 * scale, 0};
    EXPECT_THROW(check_mesh(mesh, "two triangles"), Error);
  }
}

TEST(Fingerprint, FollowsWhatMattersOnly) {
  const SerialMesh mesh = square_with_disc();
  const std::string print = fingerprint_of(mesh);
  EXPECT_EQ(print.size(), 16u);
  SerialMesh other = mesh;
  for (Point &x : other.points)
    x[0] *= 1 + 1e-15;
  EXPECT_EQ(fingerprint_of(other), print);
  other = mesh;
  other.points[7][1] += 1e-6;
  EXPECT_NE(fingerprint_of(other), print);
  other = mesh;
  for (Point &x : other.points)
    for (double &coordinate : x)
      coordinate *= 2;
  EXPECT_NE(fingerprint_of(other), print);
  other = mesh;
  other.region["obstacle"].pop_back();
  EXPECT_NE(fingerprint_of(other), print);
  other = mesh;
  std::swap(other.cells[0], other.cells[1]);
  EXPECT_NE(fingerprint_of(other), print);
  other = mesh;
  other.boundary["wall"] = other.boundary["boundary"];
  other.boundary.erase("boundary");
  EXPECT_NE(fingerprint_of(other), print);
}

TEST(PartitionCells, IsBalancedConnectedEnoughAndRepeatable) {
  const SerialMesh mesh = square_with_disc();
  for (const int parts : {1, 2, 3, 4, 7}) {
    const std::vector<int> part = partition_cells(mesh, parts);
    ASSERT_EQ(part.size(), mesh.cells.size());
    std::vector<int> size(at(parts), 0);
    std::vector<std::set<int>> vertices(parts);
    for (std::size_t c = 0; c < part.size(); ++c) {
      ++size.at(part[c]);
      vertices[part[c]].insert(mesh.cells[c].begin(), mesh.cells[c].begin() + 3);
    }
    const double average = static_cast<double>(part.size()) / parts;
    EXPECT_LE(*std::max_element(size.begin(), size.end()), 1.05 * average);
    EXPECT_GE(*std::min_element(size.begin(), size.end()), 0.95 * average);
    std::size_t copies = 0;
    for (const auto &own : vertices)
      copies += own.size();
    // A cut across the square has about 60 vertices.
    EXPECT_LE(copies - mesh.points.size(), at(80 * (parts - 1)));
    EXPECT_EQ(part, partition_cells(mesh, parts));
  }
  EXPECT_THROW(partition_cells(mesh, 6945), Error);
}

} // namespace
} // namespace rbvi::serial_mesh_test
