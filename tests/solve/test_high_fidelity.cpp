// The high-fidelity solvers agree with each other, with exact values, and across ranks.
#include "rbvi/core/error.hpp"
#include "rbvi/solve/high_fidelity.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::high_fidelity_test {
namespace {

const Mu centred{0.2, 0, 0}, shifted{0.18, 0.025, -0.025};

HfSolution solve(MPI_Comm comm, const Mu &mu, const HfOptions &options = {},
                 const SceneOptions &scene = {}, int refine = 0) {
  Problem problem(comm, make_scene("membrane_obstacle", scene), {"", refine});
  return HighFidelity(problem, options).solve(mu);
}

double relative(double value, double exact) {
  return std::abs(value / exact - 1);
}

// Exact energy, force and area: 1D Newton on the radial solution (tests/study) and, for the shifted
// disc, a solution without a mesh (errors <= 1e-11).
struct Exact {
  Mu mu;
  double energy, area, force, min_u, pressure;
};
const Exact exact[] = {{centred, -6.528778, 0.036578, 5.486761, -0.801163, 150},
                       {shifted, -6.759297, 0.028921, 5.186180, -0.906835, 179.320988}};
const SceneOptions lumped{{"lumped", "yes"}}, consistent{{"lumped", "no"}};

TEST(ActiveSet, ReachesTheExactValues) {
  for (const Exact &e : exact) {
    const HfSolution s = solve(PETSC_COMM_WORLD, e.mu, {}, consistent);
    EXPECT_LE(s.kkt.largest(), 1e-12);
    EXPECT_LE(relative(*s.outputs.energy, e.energy), 2e-3);
    EXPECT_LE(relative(*s.outputs.normal_force, e.force), 1e-3);
    EXPECT_LE(relative(*s.outputs.contact_measure, e.area), 5e-2);
    EXPECT_LE(relative(*s.outputs.min_u, e.min_u), 2e-3);
  }
}

/// The force is too small by O(h^2): nodes are in contact or not, and both cases lower the
/// membrane.
TEST(ActiveSet, VertexQuadratureHasTheExactPeakTheAreaAndTheEnergy) {
  for (const Exact &e : exact) {
    const HfSolution s = solve(PETSC_COMM_WORLD, e.mu, {}, lumped);
    EXPECT_LE(s.kkt.largest(), 1e-12);
    EXPECT_LE(relative(*s.outputs.energy, e.energy), 6e-4);
    EXPECT_LE(relative(*s.outputs.normal_force, e.force), 1.5e-3);
    EXPECT_LE(relative(*s.outputs.contact_measure, e.area), 2e-3);
    EXPECT_LE(relative(*s.outputs.peak_pressure, e.pressure), 1e-3);
    EXPECT_LE(relative(*s.outputs.min_u, e.min_u), 1e-3);
  }
}

TEST(ActiveSet, EnergyConvergesAtSecondOrder) {
  for (const Exact &e : exact)
    for (const SceneOptions &scene : {lumped, consistent}) {
      const double coarse =
          relative(*solve(PETSC_COMM_WORLD, e.mu, {}, scene).outputs.energy, e.energy);
      const double fine =
          relative(*solve(PETSC_COMM_WORLD, e.mu, {}, scene, 1).outputs.energy, e.energy);
      EXPECT_NEAR(std::log2(coarse / fine), 2, 0.2);
    }
}

/// By vertex quadrature the few Uzawa steps of a cold start already see nearly all of contact: the
/// columns are as many.
TEST(ActiveSet, AWarmStartChangesTheCostOnly) {
  for (const SceneOptions &scene : {lumped, consistent}) {
    Problem problem(PETSC_COMM_WORLD, make_scene("membrane_obstacle", scene), {});
    HighFidelity solver(problem, {});
    const HfSolution cold = solver.solve(shifted);
    solver.forget();
    (void)solver.solve({0.185, 0.03, -0.02});
    const HfSolution warm = solver.solve(shifted);
    EXPECT_EQ(cold.active, warm.active);
    EXPECT_LE((cold.u - warm.u).norm(), 1e-11 * cold.u.norm());
    EXPECT_LE((cold.lambda - warm.lambda).norm(), 1e-10 * cold.lambda.norm());
    EXPECT_LE(warm.columns, cold.columns + (scene == lumped ? 5 : -1));
  }
}

TEST(ActiveSet, DoesNotDependOnTheNumberOfRanks) {
  const HfSolution alone = solve(PETSC_COMM_SELF, shifted),
                   world = solve(PETSC_COMM_WORLD, shifted);
  EXPECT_LE((alone.u - world.u).norm(), 1e-10 * alone.u.norm());
  EXPECT_LE((alone.lambda - world.lambda).norm(), 1e-10 * alone.lambda.norm());
}

TEST(ActiveSet, BothDiscMapsSolveTheSameProblem) {
  const HfSolution similarity = solve(PETSC_COMM_WORLD, shifted);
  const HfSolution graded = solve(PETSC_COMM_WORLD, shifted, {}, {{"disc_map", "graded"}});
  EXPECT_LE(relative(*graded.outputs.energy, *similarity.outputs.energy), 1e-3);
  EXPECT_LE(relative(*graded.outputs.normal_force, *similarity.outputs.normal_force), 1e-3);
}

TEST(ActiveSet, AnUpwardLoadPressesNothing) {
  const HfSolution s = solve(PETSC_COMM_WORLD, centred, {}, {{"load", "5"}});
  EXPECT_EQ(s.lambda.norm(), 0);
  EXPECT_TRUE(s.active.empty());
  EXPECT_GT(*s.outputs.energy, -1);
}

TEST(Vi, AgreesWithTheActiveSetWhereBothHaveNodalBounds) {
  for (const Mu &mu : {centred, shifted}) {
    const HfSolution truth = solve(PETSC_COMM_WORLD, mu, {}, lumped);
    HfOptions options;
    options.method = HfMethod::vi;
    for (const char *type : {SNESVINEWTONRSLS, SNESVINEWTONSSLS}) {
      RBVI_CALL(PetscOptionsSetValue(nullptr, "-vi_snes_type", type));
      const HfSolution s = solve(PETSC_COMM_WORLD, mu, options, lumped);
      EXPECT_LE(relative(*s.outputs.energy, *truth.outputs.energy), 1e-9) << type;
      EXPECT_LE((s.u - truth.u).norm(), 1e-8 * truth.u.norm()) << type;
      EXPECT_LE((s.lambda - truth.lambda).norm(), 1e-6 * truth.lambda.norm()) << type;
    }
    RBVI_CALL(PetscOptionsClearValue(nullptr, "-vi_snes_type"));
  }
}

TEST(Vi, SaysThatItNeedsNodalBounds) {
  HfOptions options;
  options.method = HfMethod::vi;
  try {
    solve(PETSC_COMM_WORLD, centred, options, consistent);
    FAIL();
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::bad_input);
    EXPECT_NE(std::string(error.what()).find("-lumped"), std::string::npos);
  }
}

/// Relative error of the multiplier left by Uzawa, whose criterion bounds the last step only: the
/// slowest component still has about as many steps to go as it has made.
double uzawa_error(bool accelerated, double tolerance, const HfSolution &truth) {
  HfOptions options;
  options.method = HfMethod::uzawa;
  options.uzawa.tolerance = tolerance;
  options.uzawa.accelerated = accelerated;
  const HfSolution s = solve(PETSC_COMM_WORLD, shifted, options);
  EXPECT_GE(s.lambda.minCoeff(), 0);
  EXPECT_LE(relative(*s.outputs.energy, *truth.outputs.energy), 10 * tolerance);
  return (s.lambda - truth.lambda).norm() / truth.lambda.norm();
}

TEST(Uzawa, ConvergesToTheActiveSetSolution) {
  const HfSolution truth = solve(PETSC_COMM_WORLD, shifted);
  const double fixed = uzawa_error(false, 1e-5, truth);
  EXPECT_LE(fixed, 0.1);
  EXPECT_LT(uzawa_error(true, 1e-5, truth), fixed);
  EXPECT_LE(uzawa_error(true, 1e-8, truth), 1e-4);
}

/// The plain criterion stops the fixed step early where it is loose: 1e-5 compares like with like.
TEST(Uzawa, AccelerationSavesIterations) { // each rank by itself: hundreds of small solves
  HfOptions options;
  options.method = HfMethod::uzawa;
  options.uzawa.tolerance = 1e-5;
  const int fixed = solve(PETSC_COMM_SELF, shifted, options).iterations;
  options.uzawa.accelerated = true;
  EXPECT_LT(4 * solve(PETSC_COMM_SELF, shifted, options).iterations, fixed);
}

TEST(Uzawa, StoppingEarlyIsAnError) {
  HfOptions options;
  options.method = HfMethod::uzawa;
  options.uzawa.max_iterations = 3;
  try {
    solve(PETSC_COMM_SELF, centred, options);
    FAIL();
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find("-uzawa_max_iterations"), std::string::npos);
  }
}

} // namespace
} // namespace rbvi::high_fidelity_test
