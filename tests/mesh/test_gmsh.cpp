#include "gmsh_writer.hpp"
#include "rbvi/core/error.hpp"
#include "temporary_file.hpp"
#include "tests/catalogue.hpp"
#include "triangles.hpp"

namespace rbvi::gmsh_test {
namespace {

/// The built-in mesh as Gmsh would draw it, numbers clashing: the circle is curve 5 and in no
/// group, group 5 of the curves is "boundary", group 5 of the surfaces "all"; entities are in two
/// groups.
GmshDrawing membrane(const std::string &boundary = "boundary") {
  const SerialMesh mesh = square_with_disc();
  GmshDrawing drawing;
  drawing.points = mesh.points;
  drawing.names = {{{1, 5}, boundary}, {{1, 1}, "two sides"}, {{2, 1}, "obstacle"},
                   {{2, 2}, "rest"},   {{2, 5}, "all"},       {{1, 2}, "obstacle"}};
  for (const int side : {1, 2, 3, 4})
    drawing.entities.push_back(
        {1, side, side < 3 ? std::vector{1, 5} : std::vector{side == 3 ? 5 : -5}, {}});
  for (const auto &edge : mesh.boundary.at("boundary")) {
    const Point &x = mesh.points[edge[0]], &y = mesh.points[edge[1]];
    const double middle_x = (x[0] + y[0]) / 2, middle_y = (x[1] + y[1]) / 2;
    const std::size_t side = middle_y < -0.49 ? 0 : middle_x > 0.49 ? 1 : middle_y > 0.49 ? 2 : 3;
    drawing.entities[side].elements.push_back({edge[0], edge[1]});
  }
  const std::size_t disc = mesh.region.at("obstacle").size();
  GmshEntity circle{1, 5, {}, {}}, inside{2, 2, {1, -5}, {}}, rest{2, 1, {-2, 5}, {}};
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const auto &cell = mesh.cells[c];
    (c < disc ? inside : rest).elements.push_back({cell[0], cell[1], cell[2]});
    const auto on_circle = [&](int v) {
      return std::abs(std::hypot(mesh.points[v][0], mesh.points[v][1]) - 0.2) < 1e-12;
    };
    for (std::size_t i = 0; c < disc && i < 3; ++i)
      if (on_circle(cell[i]) && on_circle(cell[(i + 1) % 3]))
        circle.elements.push_back({cell[i], cell[(i + 1) % 3]});
  }
  for (GmshEntity &entity : std::vector{circle, inside, rest})
    drawing.entities.push_back(std::move(entity));
  return drawing;
}

class Encodings : public testing::TestWithParam<GmshEncoding> {
protected:
  const Scene scene = make_scene("membrane_obstacle", {{"lumped", "no"}});
};
INSTANTIATE_TEST_SUITE_P(Gmsh, Encodings, testing::ValuesIn(gmsh_encodings),
                         [](const testing::TestParamInfo<GmshEncoding> &encoding) {
                           std::string name = "v" + encoding.param.version;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name + (encoding.param.binary ? "_binary" : "_text");
                         });

/// Names belong to a dimension: the curves around the disk are called as the disk.
TEST(Gmsh, ARegionAndABoundaryMayHaveOneName) {
  GmshDrawing drawing = membrane();
  for (GmshEntity &entity : drawing.entities)
    if (entity.dim == 1 && entity.number == 5) entity.groups = {2};
  const TemporaryFile file(written(drawing, {"4.1", false}));
  Scene scene = make_scene("membrane_obstacle", {{"lumped", "no"}});
  scene.mesh.boundaries.emplace_back("obstacle");
  for (int refine = 0; refine < 2; ++refine) {
    const Mesh mesh = make_mesh(PETSC_COMM_WORLD, scene, {file.name(), refine});
    std::array<long, 2> count{std::ranges::count(mesh.region.at("obstacle"), true), 0};
    for (std::size_t node = 0; node < mesh.points.size(); ++node) {
      const double radius = std::hypot(mesh.points[node][0], mesh.points[node][1]);
      EXPECT_EQ(mesh.boundary.at("obstacle")[node], std::abs(radius - 0.2) < 2e-3);
      count[1] += mesh.owned_node[node] && mesh.boundary.at("obstacle")[node];
    }
    MPI_Allreduce(MPI_IN_PLACE, count.data(), 2, MPI_LONG, MPI_SUM, mesh.comm);
    EXPECT_EQ(count[0], (refine == 0 ? 1 : 4) * 864);
    EXPECT_EQ(count[1], (refine == 0 ? 1 : 2) * 72);
  }
}

TEST_P(Encodings, TheBuiltInMeshComesBack) {
  const TemporaryFile file(written(membrane(), GetParam()));
  const SerialMesh built = square_with_disc(), read = read_gmsh(file.name(), scene);
  EXPECT_NO_THROW(check_mesh(read, "file"));
  EXPECT_NO_THROW(check_facts(read, scene, "file"));
  EXPECT_EQ(read.points, built.points);
  EXPECT_EQ(read.cells, built.cells);
  EXPECT_EQ(read.region.at("obstacle"), built.region.at("obstacle"));
  EXPECT_EQ(read.boundary.size(), 1u);
  std::set<std::set<int>> edges, wanted;
  for (const auto &edge : read.boundary.at("boundary"))
    edges.insert({edge[0], edge[1]});
  for (const auto &edge : built.boundary.at("boundary"))
    wanted.insert({edge[0], edge[1]});
  EXPECT_EQ(read.boundary.at("boundary").size(), 200u);
  EXPECT_EQ(edges, wanted);
}

TEST_P(Encodings, AllHaveOneFingerprint) {
  std::string first;
  {
    const TemporaryFile file(written(membrane(), gmsh_encodings.front()));
    first = fingerprint_of(read_gmsh(file.name(), scene));
  }
  const TemporaryFile file(written(membrane(), GetParam()));
  EXPECT_EQ(fingerprint_of(read_gmsh(file.name(), scene)), first);
}

TEST(Gmsh, LinesMayEndAsOnWindows) {
  const std::string text = written(membrane(), {"4.1", false});
  std::string windows;
  for (const char c : text)
    windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  const Scene scene = make_scene("membrane_obstacle");
  std::string print;
  {
    const TemporaryFile file(text);
    print = fingerprint_of(read_gmsh(file.name(), scene));
  }
  const TemporaryFile file(windows);
  EXPECT_EQ(fingerprint_of(read_gmsh(file.name(), scene)), print);
}

/// As Gmsh reads them.
TEST_P(Encodings, CommentsAndAByteOrderMarkMayComeFirst) {
  const std::string text = written(membrane(), GetParam());
  const std::string comment = "$Comments\n$MeshFormat of a converter\n$EndComments\n";
  const TemporaryFile plain(text);
  const std::string print = fingerprint_of(read_gmsh(plain.name(), scene));
  for (const std::string &before :
       {comment, std::string("\xef\xbb\xbf"), "\xef\xbb\xbf" + comment + "\n" + comment}) {
    const TemporaryFile file(before + text);
    EXPECT_EQ(fingerprint_of(read_gmsh(file.name(), scene)), print);
  }
}

TEST_P(Encodings, AFileServesAsTheBuiltInMeshDoes) {
  const TemporaryFile file(written(membrane(), GetParam()));
  const Mesh read = make_mesh(PETSC_COMM_WORLD, scene, {file.name(), 1});
  const Mesh built = make_mesh(PETSC_COMM_WORLD, scene, {"", 1});
  EXPECT_EQ(read.total_vertices, built.total_vertices);
  EXPECT_EQ(read.total_cells, built.total_cells);
  EXPECT_EQ(read.fingerprint, built.fingerprint);
}

/// The unit cube in six tetrahedra about its diagonal.
const std::string cube = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
2 1 "bottom"
3 2 "block"
$EndPhysicalNames
$Nodes
8
1 0 0 0
2 1 0 0
3 0 1 0
4 1 1 0
5 0 0 1
6 1 0 1
7 0 1 1
8 1 1 1
$EndNodes
$Elements
8
1 2 2 1 1 1 2 4
2 2 2 1 1 1 4 3
3 4 2 2 1 1 2 4 8
4 4 2 2 1 1 4 3 8
5 4 2 2 1 1 3 7 8
6 4 2 2 1 1 7 5 8
7 4 2 2 1 1 5 6 8
8 4 2 2 1 1 6 2 8
$EndElements
)";

TEST(Gmsh, TetrahedraAreReadRefinedAndDistributed) {
  const TemporaryFile file(cube);
  Scene scene;
  scene.name = "block";
  scene.dim = 3;
  scene.mesh = {"", {"block"}, {"bottom"}};
  for (const int refine : {0, 1, 2}) {
    const Mesh mesh = make_mesh(PETSC_COMM_WORLD, scene, {file.name(), refine});
    const int n = 1 << refine;
    EXPECT_EQ(mesh.total_vertices, (n + 1) * (n + 1) * (n + 1));
    EXPECT_EQ(mesh.total_cells, 6 * n * n * n);
    EXPECT_EQ(count_nodes(PETSC_COMM_WORLD, scene, {file.name(), refine}), mesh.total_nodes);
    scene.degree = 2;
    EXPECT_EQ(count_nodes(PETSC_COMM_WORLD, scene, {file.name(), refine}),
              make_mesh(PETSC_COMM_WORLD, scene, {file.name(), refine}).total_nodes);
    scene.degree = 1;
    double volume = 0;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
      std::array<Point, 4> corners{};
      for (std::size_t i = 0; i < 4; ++i)
        corners[i] = mesh.points[mesh.cells[c][i]];
      const double cell = simplex(3, corners).volume;
      EXPECT_GT(cell, 0);
      volume += cell;
      EXPECT_TRUE(mesh.region.at("block")[c]);
    }
    int bottom = 0;
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
      EXPECT_EQ(mesh.boundary.at("bottom")[v], mesh.points[v][2] == 0);
      if (mesh.owned_node[v] && mesh.boundary.at("bottom")[v]) ++bottom;
    }
    MPI_Allreduce(MPI_IN_PLACE, &volume, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    MPI_Allreduce(MPI_IN_PLACE, &bottom, 1, MPI_INT, MPI_SUM, PETSC_COMM_WORLD);
    EXPECT_NEAR(volume, 1, 1e-14);
    EXPECT_EQ(bottom, (n + 1) * (n + 1));
  }
}

/// Two triangles of version 4.1, the second clockwise.
const std::string version_4 = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
1 1 "boundary"
2 2 "obstacle"
$EndPhysicalNames
$Entities
0 1 1 0
1 0 0 0 1 0 0 1 1 0
1 0 0 0 1 1 0 1 2 0
$EndEntities
$Nodes
1 4 1 4
2 1 0 4
1
2
3
4
0 0 0
1 0 0
0 1 0
1 1 0
$EndNodes
$Elements
2 3 1 3
1 1 1 1
1 1 2
2 1 2 2
2 1 2 3
3 2 3 4
$EndElements
)";

TEST(Gmsh, VersionFourIsReadAndClockwiseCellsAreTurned) {
  const TemporaryFile file(version_4);
  const SerialMesh mesh = read_gmsh(file.name(), make_scene("membrane_obstacle"));
  EXPECT_NO_THROW(check_mesh(mesh, "file"));
  EXPECT_EQ(mesh.points.size(), 4u);
  EXPECT_EQ(mesh.region.at("obstacle"), (std::vector<int>{0, 1}));
  EXPECT_EQ(mesh.boundary.at("boundary").size(), 1u);
}

/// A quarter of a mesh with the given $Elements lines; nodes 1..9 form a grid of 3 x 3 on [0, 1]^2.
std::string grid_with(const std::vector<std::string> &elements) {
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n1 1 \"boundary\"\n"
                     "2 2 \"obstacle\"\n$EndPhysicalNames\n$Nodes\n9\n";
  for (int v = 0; v < 9; ++v)
    text += std::to_string(v + 1) + " " + std::to_string(0.5 * (v % 3)) + " " +
            std::to_string(0.5 * (v / 3)) + " 0\n";
  text += "$EndNodes\n$Elements\n" + std::to_string(elements.size()) + "\n";
  for (std::size_t i = 0; i < elements.size(); ++i)
    text += std::to_string(i + 1) + " " + elements[i] + "\n";
  return text + "$EndElements\n";
}

/// Every rank gets the same bad_input, and its text contains `hint`.
void expect_refused(const std::string &file, const std::string &hint) {
  try {
    (void)make_mesh(PETSC_COMM_WORLD, make_scene("membrane_obstacle"), {file, 0});
    FAIL() << "accepted; expected: " << hint;
  } catch (const Error &error) {
    const std::string message = error.what();
    EXPECT_EQ(error.status(), Status::bad_input) << message;
    EXPECT_NE(message.find(hint), std::string::npos) << message;
    EXPECT_NE(message.find(file), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST(GmshErrors, MissingFileAndForeignFiles) {
  expect_refused("/nonexistent/mesh.msh", "cannot open");
  expect_refused("/", "not a Gmsh mesh");
  for (const std::string content : {"", "hello", "$Comments\n", "\x89HDF\r\n\x1a\n"}) {
    const TemporaryFile file(content);
    expect_refused(file.name(), "not a Gmsh mesh");
  }
  {
    const TemporaryFile file("$MeshFormat\nabc\n");
    expect_refused(file.name(), "'abc' in $MeshFormat is not the number");
  }
  const TemporaryFile file("$NOD\n1\n1 0 0 0\n$ENDNOD\n");
  expect_refused(file.name(), "of MSH version 1: 2.2, 4.0 and 4.1 are read");
}

TEST_P(Encodings, TruncatedFilesAreRefused) {
  const std::string whole = written(membrane(), GetParam());
  for (const double fraction : {0.001, 0.2, 0.5, 0.9, 0.9999}) {
    const auto length = static_cast<std::size_t>(fraction * static_cast<double>(whole.size()));
    const TemporaryFile file(whole.substr(0, length));
    expect_refused(file.name(), "cannot be read");
  }
}

TEST_P(Encodings, MissingNamesAreListedAtOnceWithThoseThatExist) {
  GmshDrawing drawing = membrane("wall");
  drawing.names.erase({2, 1});
  const TemporaryFile file(written(drawing, GetParam()));
  expect_refused(file.name(), "no physical region 'obstacle' of cells and no physical boundary "
                              "'boundary' of facets");
  expect_refused(file.name(), "it has: cells in '1', 'rest', 'all'; facets in "
                              "'two sides', 'wall'");
}

TEST_P(Encodings, AFileWithoutGroupsIsRefused) {
  GmshDrawing drawing = membrane();
  for (GmshEntity &entity : drawing.entities)
    entity.groups.clear();
  const TemporaryFile file(written(drawing, GetParam()));
  expect_refused(file.name(), "no physical region 'obstacle' of cells and no physical boundary");
  expect_refused(file.name(), "cells in none; facets in none");
}

TEST_P(Encodings, PointsOutOfThePlaneOrNotANumberAreRefused) {
  GmshDrawing drawing = membrane();
  drawing.points[17][2] = 0.01;
  {
    const TemporaryFile file(written(drawing, GetParam()));
    expect_refused(file.name(), "plane z = constant");
  }
  drawing.points[17] = {std::nan(""), 0, 0};
  const TemporaryFile file(written(drawing, GetParam()));
  expect_refused(file.name(), "node 39 is not finite");
}

TEST_P(Encodings, GroupsWithoutANameGoByTheirNumber) {
  GmshDrawing drawing = membrane();
  drawing.names.erase({2, 1});
  Scene numbered = scene;
  std::ranges::replace(numbered.mesh.regions, std::string("obstacle"), std::string("1"));
  const TemporaryFile file(written(drawing, GetParam()));
  EXPECT_EQ(read_gmsh(file.name(), numbered).region.at("1"),
            square_with_disc().region.at("obstacle"));
  EXPECT_EQ(parts_of_gmsh(file.name(), 2).first.front(), "1");
}

/// A mesh keeps its digits wherever it lies, and its plane is that of the scene.
TEST(Gmsh, TheOriginIsAnywhere) {
  const Scene scene = make_scene("membrane_obstacle", {{"lumped", "no"}});
  const auto print_of = [&](const Point &origin, double moved) {
    GmshDrawing drawing = membrane();
    drawing.points.back()[0] += moved;
    for (Point &x : drawing.points)
      x = x + origin;
    const TemporaryFile file(written(drawing, {"4.1", false}));
    return fingerprint_of(read_gmsh(file.name(), scene));
  };
  EXPECT_EQ(print_of({0, 0, 5}, 0), print_of({}, 0));
  const Point far{5e5, 4.5e6, 0};
  EXPECT_EQ(print_of(far, 1e-9), print_of(far, 0));
  EXPECT_NE(print_of(far, 1e-5), print_of(far, 0));
}

TEST_P(Encodings, AnElementOfANodeThatIsNotThereIsRefused) {
  GmshDrawing drawing = membrane();
  drawing.entities.back().elements.front().front() = 100000;
  const TemporaryFile file(written(drawing, GetParam()));
  expect_refused(file.name(), "has no node 200005");
}

TEST_P(Encodings, AnUngroupedSurfaceIsNotPassedOver) {
  GmshDrawing drawing = membrane();
  drawing.entities.pop_back(); // Gmsh does not write it then
  const TemporaryFile file(written(drawing, GetParam()));
  expect_refused(file.name(), "'boundary' on node");
  expect_refused(file.name(), "put it in a physical group");
}

TEST(GmshErrors, OtherVersionsByteOrdersPartitionsAndCountsThatAreWrong) {
  const std::string two = written(membrane(), {"2.2", false}),
                    four = written(membrane(), {"4.1", false}),
                    binary = written(membrane(), {"4.1", true});
  const auto changed = [](std::string text, const std::string &from, const std::string &to) {
    return text.replace(text.find(from), from.size(), to);
  };
  const std::string partitioned = grid_with({"2 4 2 1 1 2 1 2 4"});
  const std::pair<std::string, std::string> files[] = {
      {changed(two, "2.2 0", "2.0 0"), "version 2"},
      {changed(four, "4.1 0", "4.2 0"), "version 4.2"},
      {changed(four, "0 8", "0 4"), "4 bytes"},
      {changed(binary, std::string("1 8\n\1\0\0\0", 8), std::string("1 8\n\0\0\0\1", 8)),
       "byte order"},
      {changed(four, "$Entities", "$PartitionedEntities"), "partitioned"},
      {partitioned, "partitioned"},
      {changed(two, "$Nodes\n3574", "$Nodes\n3573"), "$Nodes goes on"},
      {changed(two, "$Nodes\n3574", "$Nodes\n3575"), "'$EndNodes' in $Nodes is not the number"},
      {changed(four, "$EndElements", "$EndNodes"), "$Elements goes on"},
      {two + "$Nodes\n0\n$EndNodes\n", "two sections $Nodes"},
      {changed(two, "\n7 ", "\n5 "), "two nodes 5"},
      {two + "end", "is not a section"}};
  for (const auto &[content, hint] : files) {
    const TemporaryFile file(content);
    expect_refused(file.name(), hint);
  }
}

TEST(GmshErrors, WrongDimensionWrongCellsOrderTwo) {
  {
    const TemporaryFile file(cube);
    expect_refused(file.name(), "dimension 3");
  }
  {
    const TemporaryFile file(grid_with({"1 2 1 1 1 2", "3 2 2 1 1 2 5 4", "3 2 2 1 2 3 6 5"}));
    expect_refused(file.name(), "not triangles");
  }
  {
    const TemporaryFile file(
        grid_with({"8 2 1 1 1 3 2", "9 2 2 1 1 3 7 2 5 4", "9 2 2 1 3 9 7 6 8 5"}));
    expect_refused(file.name(), "order 2");
  }
}

TEST(GmshErrors, FoldedAndDegenerateCells) {
  {
    const TemporaryFile file(grid_with({"1 2 1 1 1 2", "2 2 2 1 1 2 4", "2 2 2 1 1 2 5"}));
    expect_refused(file.name(), "same side");
  }
  {
    const TemporaryFile file(grid_with({"1 2 1 1 1 2", "2 2 2 1 1 2 4", "2 2 2 1 1 2 3"}));
    expect_refused(file.name(), "degenerate");
  }
}

} // namespace
} // namespace rbvi::gmsh_test
