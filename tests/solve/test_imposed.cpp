// Displacements imposed on boundaries as functions of mu and x: exact linear states, the same
// problems written another way, and data that cannot be.
#include "../coarse_mesh.hpp"
#include "../core/refuses.hpp"
#include "../cube_mesh.hpp"
#include "../mesh/temporary_file.hpp"
#include "rbvi/contact/obstacle.hpp"
#include "rbvi/contact/support.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/scalar_forms.hpp"
#include "rbvi/solve/high_fidelity.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rbvi::imposed_test {
namespace {

using Field = std::function<PointMap>;

struct Solved {
  Problem problem;
  HfSolution solution;
  Solved(const Scene &scene, const Mu &mu, const MeshOptions &mesh = {},
         MPI_Comm comm = PETSC_COMM_WORLD, const HfOptions &options = {})
      : problem(comm, scene, mesh), solution(HighFidelity(problem, options).solve(mu)) {}
};

/// Largest difference of the displacement, the motion included, from a field. Collective.
double largest_error(const Solved &of, const Mu &mu, const Field &exact) {
  const Mesh &mesh = of.problem.mesh();
  const Scene &scene = of.problem.scene();
  const FullMu all = expand(scene.parameters, mu);
  double worst = 0;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const Point motion = scene.motion ? scene.motion(all, mesh.points[v]) : Point{},
                expected = exact(all, mesh.points[v]);
    for (int c = 0; c < scene.components; ++c) {
      const auto k = static_cast<std::size_t>(c);
      const double value = of.solution.u[mesh.natural_node[v] * scene.components + c] + motion[k];
      worst = larger(worst, std::abs(value - expected[k]));
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE, MPI_MAX, of.problem.comm());
  return worst;
}

Factor parameter(const std::string &name, int number) {
  return {name, [number](const FullMu &mu) { return mu[number]; }, {number}};
}

/// A block [0, 1] x [0, 1/2] over a flat support, stretched by mu[0] along x and pressed by mu[1]:
/// u = (mu[0] x, -mu[1] y) is imposed at the top, and (mu[0] x, .) at the sides. `exact`: as sums
/// of known functions of mu; else as one function.
Scene stretched_block(int degree, bool exact, double gap) {
  Scene scene = make_scene("patch", {{"bodies", "one"}, {"friction", "none"}});
  scene.degree = degree;
  const Lame material = lame(15, 0.35);
  scene.parameters = all_free({{"stretch", "", -0.1, 0.1, 0}, {"squeeze", "", -0.1, 0.1, 0}});
  scene.motion = nullptr;
  scene.f.clear();
  scene.a = {exact_term(elasticity("", material, degree))};
  scene.v_product = {exact_term(h1_product(1, 2, degree))};
  const ImposedTerm across{[](const FullMu &, const Point &x) {
                             return Point{x[0], 0, 0};
                           },
                           std::vector{parameter("stretch", 0)}},
      down{[](const FullMu &, const Point &x) {
             return Point{0, -x[1], 0};
           },
           std::vector{parameter("squeeze", 1)}},
      both{[](const FullMu &mu, const Point &x) {
        return Point{mu[0] * x[0], -mu[1] * x[1], 0};
      }};
  if (exact)
    scene.fixed = {{"sides", {0}, {across}}, {"top", {}, {across, down}}};
  else
    scene.fixed = {{"sides", {0}, {both}}, {"top", {}, {both}}};
  scene.contacts = {rigid_support({"contact",
                                   [](const FullMu &, const Point &) {
                                     return Point{0, -1, 0};
                                   },
                                   [gap](const FullMu &, const Point &) { return gap; },
                                   {},
                                   degree == 1})};
  scene.contacts.front().entities.components = {1}; // x is imposed at the ends of the foot
  return scene;
}

Point linear(const FullMu &mu, const Point &x) {
  return {mu[0] * x[0], -mu[1] * x[1], 0};
}

/// a(u, u) / 2 on the unit by half block.
double energy_of_block(const Mu &mu) {
  const Lame material = lame(15, 0.35);
  const double trace = mu[0] - mu[1];
  return 0.5 *
         (material.lambda * trace * trace / 2 + material.shear * (mu[0] * mu[0] + mu[1] * mu[1]));
}

/// Far from the support: with sigma_yy = 0 the foot is free, and the state is linear.
TEST(Imposed, ALinearStateWithoutContactIsReproduced) {
  const Lame material = lame(15, 0.35);
  const double poisson = material.lambda / (material.lambda + 2 * material.shear);
  const Mu mu{0.07, 0.07 * poisson};
  for (const int degree : {1, 2})
    for (const bool exact : {true, false}) {
      const Solved s(stretched_block(degree, exact, 1), mu);
      EXPECT_LE(largest_error(s, mu, linear), 1e-13);
      EXPECT_EQ(s.solution.lambda.norm(), 0);
      EXPECT_NEAR(*s.solution.outputs.energy, energy_of_block(mu), 1e-14);
    }
}

/// On the support: the pressure is -sigma_yy, constant. A gap of round-off is none: B u and G are
/// nothing to measure residuals by.
TEST(Imposed, ALinearStateInContactIsReproduced) {
  const Lame material = lame(15, 0.35);
  const Mu mu{0.02, 0.05};
  const double pressure = (material.lambda + 2 * material.shear) * mu[1] - material.lambda * mu[0];
  for (const int degree : {1, 2})
    for (const auto &[exact, gap] : {std::pair{true, 0.0}, {false, 0.0}, {true, 1e-18}}) {
      const Solved s(stretched_block(degree, exact, gap), mu);
      EXPECT_LE(largest_error(s, mu, linear), 1e-13);
      EXPECT_LE((s.solution.lambda.array() - pressure).abs().maxCoeff(), 1e-12 * pressure);
      EXPECT_NEAR(*s.solution.outputs.energy, energy_of_block(mu), 1e-13);
      EXPECT_NEAR(*s.solution.outputs.normal_force, pressure, 1e-12 * pressure);
    }
}

/// Linear functions are harmonic: in 3D a scalar field over an obstacle far below.
TEST(Imposed, ALinearFieldOnTetrahedraIsReproduced) {
  const TemporaryFile file(cube_mesh(3, 0.2));
  const Field exact = [](const FullMu &mu, const Point &x) {
    return Point{mu[0] * x[0] - 2 * x[1] + x[2], 0, 0};
  };
  for (const int degree : {1, 2}) {
    Scene scene = make_scene("membrane_obstacle");
    scene.dim = 3;
    scene.degree = degree;
    scene.mesh = {"", {"core"}, {"boundary"}};
    scene.map = [](const FullMu &, const Point &x) { return x; };
    scene.curves = {};
    scene.contacts = {obstacle({"core", [](const FullMu &, const Point &) { return -9.0; }})};
    scene.a = {mapped_term(laplace("", degree))};
    scene.f.clear();
    scene.v_product = {exact_term(h1_product(1, 1, degree))};
    scene.fixed = {{"boundary", {}, {{exact}}}};
    const Mu mu{0.2, 0, 0};
    const Solved s(scene, mu, {file.name(), 0});
    EXPECT_LE(largest_error(s, mu, exact), 1e-13);
    EXPECT_NEAR(*s.solution.outputs.energy, 0.5 * (0.04 + 4 + 1), 1e-12);
  }
}

/// The rigid motion of a scene, imposed on the boundaries instead.
Scene imposed_in_place_of_motion(Scene scene) {
  const Field motion = std::exchange(scene.motion, nullptr);
  for (FixedBoundary &boundary : scene.fixed)
    boundary.values = {{motion}};
  return scene;
}

void expect_same(const Scene &moved, const Mu &mu, const HfOptions &options = {}) {
  const Solved s(moved, mu, {}, PETSC_COMM_WORLD, options),
      other(imposed_in_place_of_motion(moved), mu, {}, PETSC_COMM_WORLD, options);
  const Mesh &mesh = s.problem.mesh();
  const FullMu all = expand(moved.parameters, mu);
  double worst = 0, size = 0;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const Point motion = moved.motion(all, mesh.points[v]);
    for (int c = 0; c < 2; ++c) {
      const Index dof = 2 * mesh.natural_node[v] + c;
      const double whole = motion[c] + s.solution.u[dof];
      worst = larger(worst, std::abs(whole - other.solution.u[dof]));
      size = std::max(size, std::abs(whole));
    }
  }
  EXPECT_LE(worst, 1e-12 * size);
  EXPECT_LE((s.solution.lambda - other.solution.lambda).norm(), 1e-10 * s.solution.lambda.norm());
  const Outputs &a = s.solution.outputs, &b = other.solution.outputs;
  EXPECT_NEAR(*b.energy, *a.energy, 1e-11 * *a.energy);
  EXPECT_NEAR(*b.normal_force, *a.normal_force, 1e-11 * *a.normal_force);
  EXPECT_EQ(*b.contact_nodes, *a.contact_nodes);
}

TEST(Imposed, ARigidMotionIsTheSameAsMotion) {
  const auto disk = [](SceneOptions options) {
    options["arc_edges"] = "60";
    return make_scene("rigid_disk", options);
  };
  expect_same(make_scene("two_disks", {{"arc_edges", "60"}}), {0.9});
  expect_same(make_scene("two_disks", {{"degree", "1"}, {"arc_edges", "140"}}), {1.1});
  expect_same(disk({{"friction", "coulomb"}}), {0.9});
  expect_same(disk({{"formulation", "nitsche"}, {"friction", "none"}}), {0.9});
  HfOptions vi;
  vi.method = HfMethod::vi;
  expect_same(disk({{"friction", "none"}, {"lumped", "yes"}}), {1}, vi);
}

/// u = height + tilt x + v with v over the obstacle psi - height - tilt x: without a mesh and on
/// each. The integral of the load over the square is taken by all of height, by nothing of the
/// tilt.
TEST(Imposed, ALiftedFrameIsALoweredObstacle) {
  const Mu mu{0.19, 0.02, -0.01, 0.04, 0.3};
  const double height = mu[3], tilt = mu[4], load = -25;
  for (const char *degree : {"1", "2"})
    for (const char *lumped : {"yes", "no"})
      for (const char *map : {"similarity", "graded"}) {
        SCOPED_TRACE(std::string(degree) + lumped + map);
        Scene scene = make_scene(
            "membrane_obstacle",
            {{"degree", degree}, {"lumped", lumped}, {"disc_map", map}, {"circle_edges", "24"}});
        scene.parameters = all_free(scene.parameters.all);
        const Solved lifted(scene, mu);
        scene.fixed = {{"boundary", {}}};
        scene.contacts = {obstacle({"obstacle",
                                    [](const FullMu &all, const Point &x) {
                                      const double dx = x[0] - all[1], dy = x[1] - all[2];
                                      return -1.25 * (dx * dx + dy * dy) / (all[0] * all[0]) -
                                             all[3] - all[4] * x[0];
                                    },
                                    lumped == std::string("yes")})};
        const Solved lowered(scene, mu);
        const Mesh &mesh = lifted.problem.mesh();
        double worst = 0;
        const FullMu all(mu.begin(), mu.end());
        for (std::size_t v = 0; v < mesh.points.size(); ++v)
          if (mesh.natural_node[v] < mesh.total_vertices) {
            const PetscInt dof = mesh.natural_node[v];
            const double x = scene.map(all, mesh.points[v])[0];
            worst = larger(worst, std::abs(lifted.solution.u[dof] - height - tilt * x -
                                           lowered.solution.u[dof]));
          }
        EXPECT_LE(worst, 1e-12);
        EXPECT_EQ(lifted.solution.active, lowered.solution.active);
        EXPECT_LE((lifted.solution.lambda - lowered.solution.lambda).norm(),
                  1e-11 * lowered.solution.lambda.norm());
        EXPECT_NEAR(*lifted.solution.outputs.energy,
                    *lowered.solution.outputs.energy - load * height + tilt * tilt / 2, 1e-11);
      }
}

/// Contact up to the frame: B l is taken into G.
TEST(Imposed, ContactBesideTheFrameSeesItsHeight) {
  const TemporaryFile file(coarse_gmsh());
  for (const int degree : {1, 2})
    for (const bool lumped : {true, false}) {
      Scene scene = make_scene("membrane_obstacle", {{"degree", std::to_string(degree)}});
      scene.parameters = all_free(scene.parameters.all);
      scene.mesh.regions = {"rest"};
      scene.curves.clear();
      scene.mesh.facts.clear();
      const auto over = [&](double sunk) {
        return obstacle(
            {"rest",
             [sunk](const FullMu &, const Point &x) { return -0.3 + 0.5 * x[1] * x[1] - sunk; },
             lumped});
      };
      const Mu mu{0.2, 0, 0, 0.06, 0};
      scene.contacts = {over(0)};
      const Solved lifted(scene, mu, {file.name(), 0});
      scene.contacts = {over(mu[3])};
      scene.fixed = {{"boundary", {}}};
      const Solved lowered(scene, mu, {file.name(), 0});
      EXPECT_FALSE(lowered.solution.active.empty());
      EXPECT_LE((lifted.solution.u.array() - mu[3] - lowered.solution.u.array()).abs().maxCoeff(),
                1e-12);
      EXPECT_LE((lifted.solution.lambda - lowered.solution.lambda).norm(),
                1e-10 * lowered.solution.lambda.norm());
      EXPECT_NEAR(*lifted.solution.outputs.max_penetration,
                  *lowered.solution.outputs.max_penetration, 1e-13);
    }
}

TEST(Imposed, DoesNotDependOnRanks) {
  Scene membrane = make_scene("membrane_obstacle", {{"degree", "2"}, {"circle_edges", "24"}});
  membrane.parameters = all_free(membrane.parameters.all);
  const std::pair<Scene, Mu> cases[] = {{stretched_block(2, true, 0), {0.03, 0.04}},
                                        {membrane, {0.2, 0.01, 0, 0.05, -0.2}}};
  for (const auto &[scene, mu] : cases) {
    const HfSolution world = Solved(scene, mu).solution,
                     alone = Solved(scene, mu, {}, PETSC_COMM_SELF).solution;
    EXPECT_LE((world.u - alone.u).norm(), 1e-10 * alone.u.norm());
    EXPECT_LE((world.lambda - alone.lambda).norm(), 1e-10 * alone.lambda.norm());
    EXPECT_NEAR(*world.outputs.energy, *alone.outputs.energy,
                1e-10 * std::abs(*alone.outputs.energy));
  }
}

/// A parameter that is fixed at zero leaves nothing to compute.
TEST(Imposed, WhatIsZeroIsNotThere) {
  const Problem flat(PETSC_COMM_WORLD, make_scene("membrane_obstacle"), {});
  EXPECT_EQ(flat.scene().f.size(), 1U);
  EXPECT_TRUE(flat.dofs().imposed_by.empty());
  EXPECT_TRUE(flat.imposed_energy().sum.empty());
}

TEST(Imposed, ValuesThatContradictEachOtherAreRefused) {
  Scene scene = stretched_block(1, true, 0);
  scene.fixed[0].values.clear(); // the sides stay, the top does not
  EXPECT_TRUE(refuses("the boundaries 'sides' and 'top' impose different displacements", [&] {
    Solved(scene, {0, 0.05});
  }));
  scene = stretched_block(1, true, 0);
  scene.fixed[0].values.front().theta = {}; // agree to round-off
  scene.fixed[0].values.front().value = [](const FullMu &mu, const Point &x) {
    return Point{mu[0] * x[0] * (1 + 1e-13), 0, 0};
  };
  EXPECT_NO_THROW(Solved(scene, {0.02, 0.05}));
  scene.fixed[0].values.front().value = [](const FullMu &mu, const Point &x) {
    return Point{mu[0] * x[0] * (1 + (mu[0] < 0 ? 1e-9 : 0)), 0, 0}; // at some mu
  };
  Problem problem(PETSC_COMM_WORLD, scene, {});
  EXPECT_NO_THROW(problem.assemble({0.02, 0.05}));
  EXPECT_TRUE(refuses("stretch=-0.05 squeeze=0.01", [&] { problem.assemble({-0.05, 0.01}); }));
}

TEST(Imposed, ValuesThatAreNotFiniteAreRefused) {
  for (const bool exact : {true, false}) {
    Scene scene = stretched_block(1, exact, 0);
    scene.fixed[1].values.front().value = [](const FullMu &, const Point &x) {
      return Point{x[0] > 0.4 ? std::numeric_limits<double>::quiet_NaN() : 0, 0, 0};
    };
    EXPECT_TRUE(
        refuses("the displacement imposed on the boundary 'top' is not finite at stretch=", [&] {
          Solved(scene, {0.02, 0.05});
        }));
  }
}

} // namespace
} // namespace rbvi::imposed_test
