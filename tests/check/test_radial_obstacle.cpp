// The high-fidelity solution against a closed form: a membrane on a disc over a paraboloid.
#include "rbvi/check/radial_obstacle.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/scalar_forms.hpp"
#include "rbvi/solve/high_fidelity.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

namespace rbvi {
namespace {

constexpr double rim = 0.5, load = -25, curvature = 20, region = 0.3;

TEST(RadialObstacle, SatisfiesItsOwnEquations) {
  const RadialObstacle o = radial_obstacle(rim, load, curvature);
  EXPECT_NEAR(o.u(rim), 0, 1e-15);
  EXPECT_LT(o.s, region);
  const double h = 1e-5, x = 0.4; // -u'' - u'/rho = f outside the contact set
  EXPECT_NEAR(-(o.u(x + h) - 2 * o.u(x) + o.u(x - h)) / (h * h) -
                  (o.u(x + h) - o.u(x - h)) / (2 * h * x),
              load, 1e-4);
  EXPECT_NEAR(o.u(o.s * (1 + 1e-9)), o.u(o.s), 1e-8); // C1 at the edge of contact
  EXPECT_NEAR((o.u(o.s + h) - o.u(o.s)) / h, (o.u(o.s) - o.u(o.s - h)) / h, 1e-2);
}

TEST(RadialObstacle, EnergyIsTheIntegralOfTheSolution) {
  const RadialObstacle o = radial_obstacle(rim, load, curvature);
  double energy = 0;
  const int n = 200000;
  for (int i = 0; i < n; ++i) {
    const double h = rim / n, x = (i + 0.5) * h;
    const double slope = (o.u(x + h / 2) - o.u(x - h / 2)) / h;
    energy += 2 * std::numbers::pi * x * h * (slope * slope / 2 - load * o.u(x));
  }
  EXPECT_NEAR(energy, o.energy(), 1e-7 * std::abs(o.energy()));
}

TEST(RadialObstacle, RefusesDataWithoutContact) {
  EXPECT_THROW(radial_obstacle(rim, 1, curvature), Error);
  EXPECT_THROW(radial_obstacle(rim, load, -1), Error);
}

/// Gmsh text of a disc of `rings` rings of 6 k nodes; region "obstacle" up to 0.3.
std::string disc_mesh(int rings) {
  std::string nodes, elements;
  int count = 0, element = 0;
  const auto first = [](int k) { return k == 0 ? 1 : 2 + 3 * k * (k - 1); };
  const auto node = [&](int k, int i) { return k == 0 ? 1 : first(k) + i % (6 * k); };
  for (int k = 0; k <= rings; ++k)
    for (int i = 0; i < std::max(1, 6 * k); ++i) {
      const double angle = k == 0 ? 0 : std::numbers::pi * i / (3 * k), r = rim * k / rings;
      char line[128];
      std::snprintf(line, sizeof line, "%d %.17g %.17g 0\n", ++count, r * std::cos(angle),
                    r * std::sin(angle));
      nodes += line;
    }
  const auto triangle = [&](int k, int a, int b, int c) {
    const int tag = rim * k / rings <= region + 1e-12 ? 2 : 3;
    elements += std::to_string(++element) + " 2 2 " + std::to_string(tag) + " 1 " +
                std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
  };
  for (int k = 1; k <= rings; ++k)
    for (int s = 0; s < 6; ++s)
      for (int i = 0; i < k; ++i) {
        triangle(k, node(k - 1, s * (k - 1) + i), node(k, s * k + i), node(k, s * k + i + 1));
        if (i + 1 < k)
          triangle(k, node(k - 1, s * (k - 1) + i), node(k, s * k + i + 1),
                   node(k - 1, s * (k - 1) + i + 1));
      }
  for (int i = 0; i < 6 * rings; ++i)
    elements += std::to_string(++element) + " 1 2 1 1 " + std::to_string(node(rings, i)) + " " +
                std::to_string(node(rings, i + 1)) + "\n";
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"boundary\"\n2 2 "
         "\"obstacle\"\n"
         "2 3 \"rest\"\n$EndPhysicalNames\n$Nodes\n" +
         std::to_string(count) + "\n" + nodes + "$EndNodes\n$Elements\n" + std::to_string(element) +
         "\n" + elements + "$EndElements\n";
}

Scene radial_scene() {
  Scene scene = make_scene("membrane_obstacle");
  scene.mesh.facts.clear(); // a disc in place of the square
  scene.map = [](const Mu &, const Point &x) { return x; };
  scene.obstacle = [](const Mu &, const Point &x) {
    return -curvature * (x[0] * x[0] + x[1] * x[1]);
  };
  scene.g = function_load("obstacle", -1, scene.obstacle);
  return scene;
}

HfSolution solve_on_disc(int rings) {
  int rank = 0, process = static_cast<int>(getpid());
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Bcast(&process, 1, MPI_INT, 0, PETSC_COMM_WORLD);
  const auto file =
      std::filesystem::temp_directory_path() / ("rbvi_disc_" + std::to_string(process) + ".msh");
  if (rank == 0) std::ofstream(file) << disc_mesh(rings);
  MPI_Barrier(PETSC_COMM_WORLD);
  Problem problem(PETSC_COMM_WORLD, radial_scene(), {file.string(), 0});
  if (rank == 0) std::filesystem::remove(file);
  return HighFidelity(problem, {}).solve({0.2, 0, 0});
}

TEST(HighFidelity, ConvergesToTheRadialSolution) {
  const RadialObstacle o = radial_obstacle(rim, load, curvature);
  std::vector<double> energy, force;
  for (const int rings : {10, 20, 40}) {
    const HfSolution s = solve_on_disc(rings);
    EXPECT_LE(s.kkt.largest(), 1e-12);
    energy.push_back(std::abs(*s.outputs.energy / o.energy() - 1));
    force.push_back(std::abs(*s.outputs.normal_force / o.force() - 1));
  }
  EXPECT_LE(energy[2], 1.5e-3);
  EXPECT_GT(std::log2(energy[0] / energy[1]), 1.8);
  EXPECT_GT(std::log2(energy[1] / energy[2]), 1.8);
  EXPECT_LE(force[2], 1e-2);
}

} // namespace
} // namespace rbvi
