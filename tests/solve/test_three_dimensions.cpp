// The same code in three dimensions: a block of tetrahedra over an obstacle in its middle.
#include "rbvi/contact/obstacle/obstacle.hpp"
#include "rbvi/element/scalar_forms.hpp"
#include "rbvi/solve/high_fidelity.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace rbvi {
namespace {

/// Gmsh text of the unit cube in n^3 boxes of six tetrahedra; region "core": the middle third.
std::string cube_mesh(int n) {
  std::ostringstream nodes, elements;
  int element = 0;
  const auto node = [n](int i, int j, int k) { return 1 + i + (n + 1) * (j + (n + 1) * k); };
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i)
        nodes << node(i, j, k) << " " << double(i) / n << " " << double(j) / n << " "
              << double(k) / n << "\n";
  const auto add = [&](int type, int tag, const std::vector<int> &vertices) {
    elements << ++element << " " << type << " 2 " << tag << " 1";
    for (const int v : vertices)
      elements << " " << v;
    elements << "\n";
  };
  const auto inside = [n](int i) { return 3 * i >= n && 3 * (i + 1) <= 2 * n; };
  const int steps[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        for (const auto &step :
             steps) { // Kuhn: from corner to corner along the axes in every order
          int at[3] = {i, j, k};
          std::vector<int> vertices{node(at[0], at[1], at[2])};
          for (const int axis : step) {
            ++at[axis];
            vertices.push_back(node(at[0], at[1], at[2]));
          }
          add(4, inside(i) && inside(j) && inside(k) ? 2 : 3, vertices);
        }
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int p = 0; p < n; ++p)
        for (int q = 0; q < n; ++q) {
          const auto corner = [&](int a, int b) {
            int at[3];
            at[axis] = side;
            at[(axis + 1) % 3] = p + a;
            at[(axis + 2) % 3] = q + b;
            return node(at[0], at[1], at[2]);
          };
          add(2, 1, {corner(0, 0), corner(1, 0), corner(1, 1)});
          add(2, 1, {corner(0, 0), corner(0, 1), corner(1, 1)});
        }
  std::ostringstream out;
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n2 1 \"boundary\"\n3 2 \"core\"\n"
      << "3 3 \"rest\"\n$EndPhysicalNames\n$Nodes\n"
      << (n + 1) * (n + 1) * (n + 1) << "\n"
      << nodes.str() << "$EndNodes\n$Elements\n"
      << element << "\n"
      << elements.str() << "$EndElements\n";
  return out.str();
}

Scene cube_scene() {
  Scene scene = make_scene("membrane_obstacle");
  scene.dim = 3;
  scene.mesh = {"", {"core"}, {"boundary"}};
  scene.map = [](const FullMu &mu, const Point &x) {
    return Point{x[0], x[1], mu[0] / 0.2 * x[2]};
  };
  scene.snap = {};
  scene.contacts = {obstacle({"core", [](const FullMu &, const Point &) { return -0.5; }})};
  scene.a = laplace("");
  scene.f = constant_load("", -25);
  return scene;
}

HfSolution solve(MPI_Comm comm, const std::string &file) {
  Problem problem(comm, cube_scene(), {file, 0});
  return HighFidelity(problem, {}).solve({0.2, 0, 0});
}

TEST(ThreeDimensions, TheActiveSetSolvesAndDoesNotDependOnRanks) {
  int rank = 0, process = static_cast<int>(getpid());
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Bcast(&process, 1, MPI_INT, 0, PETSC_COMM_WORLD);
  const auto file =
      std::filesystem::temp_directory_path() / ("rbvi_cube_" + std::to_string(process) + ".msh");
  if (rank == 0) std::ofstream(file) << cube_mesh(6);
  MPI_Barrier(PETSC_COMM_WORLD);
  const HfSolution world = solve(PETSC_COMM_WORLD, file.string());
  const HfSolution alone = solve(PETSC_COMM_SELF, file.string());
  MPI_Barrier(PETSC_COMM_WORLD);
  if (rank == 0) std::filesystem::remove(file);
  EXPECT_LE(world.kkt.largest(), 1e-12);
  EXPECT_FALSE(world.active.empty());
  EXPECT_LT(world.active.size(), static_cast<std::size_t>(world.lambda.size()) + 1);
  EXPECT_LE((world.u - alone.u).norm(), 1e-10 * alone.u.norm());
  EXPECT_LE((world.lambda - alone.lambda).norm(), 1e-10 * alone.lambda.norm());
  // Without the obstacle the middle would sink to about -25 * 0.0562 = -1.4.
  EXPECT_GT(*world.outputs.min_u, -1.4);
  EXPECT_LT(*world.outputs.min_u, -0.45);
}

} // namespace
} // namespace rbvi
