// Obstacles under displacements of degree 2: the pressure keeps the hats of the vertices.
#include "../cube_mesh.hpp"
#include "../mesh/temporary_file.hpp"
#include "rbvi/contact/obstacle.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/scalar_forms.hpp"
#include "rbvi/solve/high_fidelity.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::quadratic_obstacle_test {
namespace {

/// Energies and forces without a mesh, see test_high_fidelity.cpp.
struct Exact {
  Mu mu;
  double energy, force;
};
const Exact exact[] = {{{0.2, 0, 0}, -6.528778, 5.486761},
                       {{0.18, 0.025, -0.025}, -6.759297, 5.186180}};

SceneOptions quadratic(const char *lumped, const char *edges = "24") {
  return {{"degree", "2"}, {"lumped", lumped}, {"circle_edges", edges}};
}

HfSolution solve(MPI_Comm comm, const Mu &mu, const SceneOptions &scene, int refine = 0,
                 const HfOptions &options = {}) {
  Problem problem(comm, make_scene("membrane_obstacle", scene), {"", refine});
  return HighFidelity(problem, options).solve(mu);
}

/// u is in H^(5/2 - eps), as its second derivatives jump at the edge of contact: with exact
/// integrals the order of the energy is 3, where degree 1 has 2.
TEST(QuadraticObstacle, EnergyConvergesAtThirdOrder) {
  for (const Exact &e : exact) {
    std::vector<double> errors;
    for (const int refine : {0, 1, 2}) {
      const HfSolution s = solve(PETSC_COMM_WORLD, e.mu, quadratic("no"), refine);
      EXPECT_LE(s.kkt.largest(), 1e-12);
      errors.push_back(std::abs(*s.outputs.energy / e.energy - 1));
    }
    EXPECT_GT(std::log2(errors[0] / errors[2]) / 2, 2.6) << errors[0] << " " << errors[2];
    EXPECT_LE(errors[2], 2e-5);
  }
}

/// The pressure of vertex quadrature pushes at the vertices alone, and the membrane sags between
/// them by a part of h^2 with a slope of h: order 2 of the energy, as of degree 1.
TEST(QuadraticObstacle, VertexQuadratureStaysAtTheOrderOfDegreeOne) {
  for (const Exact &e : exact) {
    std::vector<double> energy, force;
    for (const int refine : {0, 1}) {
      const HfSolution s = solve(PETSC_COMM_WORLD, e.mu, quadratic("yes", "36"), refine);
      EXPECT_LE(s.kkt.largest(), 1e-12);
      energy.push_back(std::abs(*s.outputs.energy / e.energy - 1));
      force.push_back(std::abs(*s.outputs.normal_force / e.force - 1));
    }
    EXPECT_NEAR(std::log2(energy[0] / energy[1]), 2, 0.3);
    EXPECT_LE(energy[1], 3e-3);
    EXPECT_LE(force[1], 2e-3);
  }
}

/// On one mesh of vertices: halved twice, degree 1 has come to what degree 2 says at once.
TEST(QuadraticObstacle, BothDegreesAgreeUnderRefinement) {
  for (const Exact &e : exact) {
    const double two = *solve(PETSC_COMM_WORLD, e.mu, quadratic("no", "24"), 1).outputs.energy;
    double before = 0;
    for (const int refine : {0, 1, 2}) {
      const SceneOptions linear{{"lumped", "no"}, {"circle_edges", "24"}};
      const double one = *solve(PETSC_COMM_WORLD, e.mu, linear, refine).outputs.energy;
      const double apart = std::abs(one - two) / std::abs(two);
      EXPECT_TRUE(refine == 0 || apart < 0.35 * before) << apart << " after " << before;
      before = apart;
    }
    EXPECT_LE(before, 7e-4); // of 96 edges; 3e-4 of 144, as the order is 2
  }
}

TEST(QuadraticObstacle, AllMethodsAgree) {
  HfOptions vi, uzawa;
  vi.method = HfMethod::vi;
  uzawa.method = HfMethod::uzawa;
  uzawa.uzawa.accelerated = true;
  uzawa.uzawa.tolerance = 1e-9;
  const MPI_Comm world = PETSC_COMM_WORLD;
  for (const Exact &e : exact) {
    const HfSolution lumped = solve(world, e.mu, quadratic("yes"));
    const HfSolution bounded = solve(world, e.mu, quadratic("yes"), 0, vi);
    EXPECT_EQ(bounded.active, lumped.active);
    EXPECT_LE((bounded.u - lumped.u).norm(), 1e-11 * lumped.u.norm());
    EXPECT_LE((bounded.lambda - lumped.lambda).norm(), 1e-10 * lumped.lambda.norm());
    const HfSolution whole = solve(world, e.mu, quadratic("no"));
    const HfSolution steps = solve(world, e.mu, quadratic("no"), 0, uzawa);
    EXPECT_LE((steps.u - whole.u).norm(), 1e-6 * whole.u.norm());
    EXPECT_THROW(solve(world, e.mu, quadratic("no"), 0, vi), Error) << "no bound at single nodes";
  }
}

TEST(QuadraticObstacle, DoesNotDependOnRanks) {
  for (const char *lumped : {"yes", "no"}) {
    const HfSolution world = solve(PETSC_COMM_WORLD, exact[1].mu, quadratic(lumped));
    const HfSolution alone = solve(PETSC_COMM_SELF, exact[1].mu, quadratic(lumped));
    EXPECT_LE((world.u - alone.u).norm(), 1e-10 * alone.u.norm());
    EXPECT_LE((world.lambda - alone.lambda).norm(), 1e-10 * alone.lambda.norm());
  }
}

/// A cube of tetrahedra whose middle third rests on a floor.
HfSolution solve_cube(MPI_Comm comm, const std::string &file, int degree, bool lumped,
                      HfMethod method = HfMethod::active_set) {
  Scene scene = make_scene("membrane_obstacle");
  scene.dim = 3;
  scene.degree = degree;
  scene.mesh = {"", {"core"}, {"boundary"}};
  scene.map = [](const FullMu &mu, const Point &x) {
    return Point{x[0], x[1], mu[0] / 0.2 * x[2]};
  };
  scene.curves = {};
  scene.contacts = {obstacle({"core", [](const FullMu &, const Point &) { return -0.5; }, lumped})};
  scene.a = {mapped_term(laplace("", degree))};
  scene.v_product = {exact_term(h1_product(1, 1, degree))};
  scene.f = {mapped_term(constant_load("", -25, degree))};
  Problem problem(comm, scene, {file, 0});
  HfOptions options;
  options.method = method;
  return HighFidelity(problem, options).solve({0.2, 0, 0});
}

TEST(QuadraticObstacle, OnTetrahedraMethodsAndRanksAgree) {
  const TemporaryFile file(cube_mesh(6));
  for (const bool lumped : {true, false}) {
    const HfSolution world = solve_cube(PETSC_COMM_WORLD, file.name(), 2, lumped);
    const HfSolution alone = solve_cube(PETSC_COMM_SELF, file.name(), 2, lumped);
    EXPECT_LE(world.kkt.largest(), 1e-12);
    EXPECT_FALSE(world.active.empty());
    EXPECT_LE((world.u - alone.u).norm(), 1e-10 * alone.u.norm());
    EXPECT_LE((world.lambda - alone.lambda).norm(), 1e-10 * alone.lambda.norm());
    if (!lumped) continue;
    const HfSolution vi = solve_cube(PETSC_COMM_WORLD, file.name(), 2, true, HfMethod::vi);
    EXPECT_EQ(vi.active, world.active);
    EXPECT_LE((vi.u - world.u).norm(), 1e-11 * world.u.norm());
    EXPECT_LE((vi.lambda - world.lambda).norm(), 1e-10 * world.lambda.norm());
  }
}

/// On twice as fine a mesh of degree 1 the energy is closer to that of degree 2.
TEST(QuadraticObstacle, OnTetrahedraBothDegreesAgreeUnderRefinement) {
  std::vector<double> energy;
  const TemporaryFile coarse(cube_mesh(6));
  const double two = *solve_cube(PETSC_COMM_WORLD, coarse.name(), 2, false).outputs.energy;
  for (const int n : {6, 12}) {
    const TemporaryFile file(cube_mesh(n));
    energy.push_back(*solve_cube(PETSC_COMM_WORLD, file.name(), 1, false).outputs.energy);
  }
  EXPECT_LT(std::abs(energy[1] - two), 0.4 * std::abs(energy[0] - two));
  EXPECT_NEAR(energy[1], two, 0.1 * std::abs(two));
}

} // namespace
} // namespace rbvi::quadratic_obstacle_test
