#include "rbvi/core/error.hpp"
#include "rbvi/element/geometry.hpp"
#include "rbvi/mesh/serial.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>

namespace rbvi {
namespace {

/// Collective. A file that the first rank writes before anyone reads, and removes after.
class TemporaryFile {
public:
  explicit TemporaryFile(const std::string &content) {
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank_);
    int process = static_cast<int>(getpid());
    MPI_Bcast(&process, 1, MPI_INT, 0, PETSC_COMM_WORLD);
    path_ = std::filesystem::temp_directory_path() / ("rbvi_" + std::to_string(process) + ".msh");
    if (rank_ == 0) std::ofstream(path_, std::ios::binary) << content;
    MPI_Barrier(PETSC_COMM_WORLD);
  }
  TemporaryFile(const TemporaryFile &) = delete;
  TemporaryFile &operator=(const TemporaryFile &) = delete;
  ~TemporaryFile() {
    MPI_Barrier(PETSC_COMM_WORLD);
    std::error_code ignored;
    if (rank_ == 0) std::filesystem::remove(path_, ignored);
  }
  std::string name() const { return path_.string(); }

private:
  std::filesystem::path path_;
  int rank_ = 0;
};

/// Gmsh 2.2 text of a 2D mesh with regions "obstacle", "rest" and boundary `boundary`; node
/// numbers have gaps, and the last node belongs to no cell.
std::string as_text(const SerialMesh &mesh, const std::string &boundary = "boundary") {
  std::ostringstream out;
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 7 \"" << boundary
      << "\"\n2 3 \"obstacle\"\n2 4 \"rest\"\n$EndPhysicalNames\n$Nodes\n"
      << mesh.points.size() + 1 << "\n"
      << std::setprecision(17);
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    out << 2 * v + 5 << " " << mesh.points[v][0] << " " << mesh.points[v][1] << " 0\n";
  out << 2 * mesh.points.size() + 5 << " 9 9 0\n$EndNodes\n$Elements\n";
  const auto &edges = mesh.boundary.at("boundary");
  out << edges.size() + mesh.cells.size() << "\n";
  std::size_t element = 0;
  for (const auto &edge : edges)
    out << ++element << " 1 2 7 1 " << 2 * edge[0] + 5 << " " << 2 * edge[1] + 5 << "\n";
  const auto &disc = mesh.region.at("obstacle");
  for (int c = 0; c < static_cast<int>(mesh.cells.size()); ++c) {
    const auto &cell = mesh.cells[static_cast<std::size_t>(c)];
    out << ++element << " 2 2 " << (std::binary_search(disc.begin(), disc.end(), c) ? 3 : 4)
        << " 1 " << 2 * cell[0] + 5 << " " << 2 * cell[1] + 5 << " " << 2 * cell[2] + 5 << "\n";
  }
  out << "$EndElements\n";
  return out.str();
}

template <class T> void put(std::string &bytes, T value) {
  bytes.append(reinterpret_cast<const char *>(&value), sizeof value);
}

/// The same in binary.
std::string as_binary(const SerialMesh &mesh) {
  std::string bytes = "$MeshFormat\n2.2 1 8\n";
  put(bytes, 1);
  bytes += "\n$EndMeshFormat\n$PhysicalNames\n2\n1 7 \"boundary\"\n2 3 \"obstacle\"\n"
           "$EndPhysicalNames\n$Nodes\n" +
           std::to_string(mesh.points.size()) + "\n";
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    put(bytes, static_cast<int>(v) + 1);
    for (const double coordinate : mesh.points[v])
      put(bytes, coordinate);
  }
  const auto &edges = mesh.boundary.at("boundary");
  bytes += "\n$EndNodes\n$Elements\n" + std::to_string(edges.size() + mesh.cells.size()) + "\n";
  int element = 0;
  for (const int value : {1, static_cast<int>(edges.size()), 2})
    put(bytes, value);
  for (const auto &edge : edges)
    for (const int value : {++element, 7, 1, edge[0] + 1, edge[1] + 1})
      put(bytes, value);
  for (const int value : {2, static_cast<int>(mesh.cells.size()), 2})
    put(bytes, value);
  const auto &disc = mesh.region.at("obstacle");
  for (int c = 0; c < static_cast<int>(mesh.cells.size()); ++c) {
    const auto &cell = mesh.cells[static_cast<std::size_t>(c)];
    const int tag = std::binary_search(disc.begin(), disc.end(), c) ? 3 : 4;
    for (const int value : {++element, tag, 1, cell[0] + 1, cell[1] + 1, cell[2] + 1})
      put(bytes, value);
  }
  return bytes + "\n$EndElements\n";
}

void expect_square_with_disc(const std::string &content) {
  const TemporaryFile file(content);
  const Scene scene = make_scene("membrane_obstacle");
  const SerialMesh built = square_with_disc();
  const SerialMesh read = read_gmsh(file.name(), scene);
  EXPECT_NO_THROW(check_mesh(read, "file"));
  EXPECT_EQ(read.points, built.points);
  EXPECT_EQ(read.cells.size(), built.cells.size());
  EXPECT_EQ(read.boundary.at("boundary").size(), 200u);
  ASSERT_EQ(read.region.at("obstacle"), built.region.at("obstacle"));
  for (const int c : read.region.at("obstacle"))
    for (std::size_t i = 0; i < 3; ++i) {
      const int v = read.cells[static_cast<std::size_t>(c)][i];
      const Point &x = read.points[static_cast<std::size_t>(v)];
      EXPECT_LE(std::hypot(x[0], x[1]), 0.2 * (1 + 1e-14));
    }
}

TEST(Gmsh, RoundTripOfTheBuiltInMeshAsText) {
  expect_square_with_disc(as_text(square_with_disc()));
}

TEST(Gmsh, RoundTripOfTheBuiltInMeshInBinary) {
  expect_square_with_disc(as_binary(square_with_disc()));
}

TEST(Gmsh, AFileServesAsTheBuiltInMeshDoes) {
  const TemporaryFile file(as_text(square_with_disc()));
  const Scene scene = make_scene("membrane_obstacle");
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
    double volume = 0;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
      std::array<Point, 4> corners{};
      for (std::size_t i = 0; i < 4; ++i)
        corners[i] = mesh.points[static_cast<std::size_t>(mesh.cells[c][i])];
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
  for (const std::string content : {"", "hello", "$MeshFormat\nabc\n", "\x89HDF\r\n\x1a\n"}) {
    const TemporaryFile file(content);
    expect_refused(file.name(), "not a Gmsh mesh");
  }
}

TEST(GmshErrors, TruncatedFiles) {
  const std::string text = as_text(square_with_disc()), binary = as_binary(square_with_disc());
  for (const double fraction : {0.001, 0.2, 0.5, 0.9}) {
    for (const std::string &whole : {text, binary}) {
      const auto length = static_cast<std::size_t>(fraction * static_cast<double>(whole.size()));
      const TemporaryFile file(whole.substr(0, length));
      expect_refused(file.name(), "cannot be read");
    }
  }
}

TEST(GmshErrors, MissingNamesAreListedWithThoseThatExist) {
  const TemporaryFile file(as_text(square_with_disc(), "wall"));
  expect_refused(file.name(), "no physical boundary 'boundary'");
  expect_refused(file.name(), "it has: ");
  expect_refused(file.name(), "wall");
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
} // namespace rbvi
