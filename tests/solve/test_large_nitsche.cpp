// Contact of the deformed body by Nitsche's method: against values found by another code, the mixed
// method, and with other loops, starts and ranks.
#include "rbvi/core/error.hpp"
#include "rbvi/solve/high_fidelity.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <span>

namespace rbvi::large_nitsche_test {
namespace {

/// Free: radius, indentation, offset.
Scene disk(const std::string &friction, SceneOptions options = {}) {
  options["friction"] = friction;
  options["kinematics"] = "large";
  options.try_emplace("formulation", "nitsche");
  Scene scene = make_scene("rigid_disk", options);
  scene.parameters = free_only(scene.parameters, "radius,indentation,offset");
  if (has_friction(scene)) scene.parameters.all[2].value = 0.2;
  return scene;
}

Scene coarse_disk(const std::string &friction) {
  return disk(friction, {{"arc_edges", "80"}});
}

HfSolution solve(MPI_Comm comm, const Scene &scene, const Mu &mu, const HfOptions &options = {}) {
  Problem problem(comm, scene, {});
  return HighFidelity(problem, options).solve(mu);
}

/// On each rank by itself.
HfSolution solve(const Scene &scene, const Mu &mu, const HfOptions &options = {}) {
  return solve(PETSC_COMM_SELF, scene, mu, options);
}

/// Mesh limits, computed independently.
struct Known {
  double d, energy, force, reaction, peak;
};

void expect_known(const std::string &friction, std::span<const Known> known) {
  Problem problem(PETSC_COMM_SELF, disk(friction), {});
  for (const Known &k : known) {
    SCOPED_TRACE(k.d);
    const HfSolution s = HighFidelity(problem, {}).solve({1, k.d, 0});
    // The narrow contact has 20 of the 316 edges.
    const bool narrow = k.d < 0.02;
    EXPECT_NEAR(*s.outputs.energy, k.energy, (narrow ? 1e-3 : 2e-4) * k.energy);
    EXPECT_NEAR(*s.outputs.normal_force, k.force, (narrow ? 1e-3 : 5e-4) * k.force);
    EXPECT_NEAR(*s.outputs.reaction, k.reaction, (narrow ? 1e-3 : 5e-4) * k.reaction);
    EXPECT_NEAR(*s.outputs.peak_pressure, k.peak, 1e-2 * k.peak); // sigma_n at a vertex
    EXPECT_LE(s.kkt.largest(), 1e-11);
    EXPECT_EQ(*s.outputs.ends_in_contact, 0);
  }
}

TEST(LargeNitsche, AgreesWithTheKnownValues) {
  const Known none[] = {{0.01, 2.762623e-4, 0.065929, 0.065909, 0.8448},
                        {0.09, 0.04129837, 1.041042, 1.036344, 3.4379},
                        {0.2, 0.2527598, 2.915214, 2.877934, 6.0886}};
  expect_known("none", none);
  const Known coulomb[] = {{0.09, 0.04131712, 1.039461, 1.036617, 3.4690},
                           {0.2, 0.2544494, 2.901304, 2.924280, 5.8848}};
  expect_known("coulomb", coulomb);
}

TEST(LargeNitsche, AgreesWithTheKnownValuesOffCentre) {
  const HfSolution none = solve(disk("none"), {1, 0.1, 0.1}),
                   rough = solve(disk("coulomb"), {1, 0.1, 0.1});
  EXPECT_NEAR(*none.outputs.energy, 0.0493125, 2e-4 * 0.0493125);
  EXPECT_NEAR(*none.outputs.normal_force, 1.15046, 1e-3 * 1.15046);
  EXPECT_NEAR(*none.outputs.horizontal_reaction, -0.060644, 2e-3 * 0.060644);
  EXPECT_NEAR(*rough.outputs.energy, 0.0495114, 2e-4 * 0.0495114);
  EXPECT_NEAR(*rough.outputs.horizontal_reaction, -0.014750, 5e-3 * 0.014750);
  EXPECT_NEAR(*rough.outputs.tangential_force, 0.06759, 5e-3 * 0.06759);
}

TEST(LargeNitsche, AgreesWithTheMixedMethodUnderEveryLaw) {
  for (const char *friction : {"none", "tresca", "coulomb"}) {
    SCOPED_TRACE(friction);
    const Mu mu{0.9, 0.15, -0.06};
    const HfSolution here = solve(disk(friction, {{"arc_edges", "200"}}), mu),
                     mixed = solve(disk(friction, {{"formulation", "mixed"}}), mu);
    EXPECT_NEAR(*here.outputs.energy, *mixed.outputs.energy, 2e-4 * *mixed.outputs.energy);
    EXPECT_NEAR(*here.outputs.reaction, *mixed.outputs.reaction, 5e-4 * *mixed.outputs.reaction);
    EXPECT_NEAR(*here.outputs.horizontal_reaction, *mixed.outputs.horizontal_reaction,
                5e-4 * *mixed.outputs.reaction);
  }
}

// The axes turn with every Newton step, and the tangent knows almost all of it.
TEST(LargeNitsche, FewStepsSufficeFromRest) {
  Problem problem(PETSC_COMM_SELF, coarse_disk("none"), {});
  for (const Mu &mu : {Mu{1, 0.01, 0}, {1, 0.2, 0}, {1, 0.2, 0.1}, {0.7, 0.2, -0.1}})
    EXPECT_LE(HighFidelity(problem, {}).solve(mu).iterations, 12);
}

TEST(LargeNitsche, TheLoopAndTheStartDoNotMatter) {
  for (const char *friction : {"none", "tresca", "coulomb"}) {
    SCOPED_TRACE(friction);
    Problem problem(PETSC_COMM_SELF, coarse_disk(friction), {});
    HighFidelity warm(problem, {});
    (void)warm.solve({1, 0.05, -0.1});
    HfOptions single;
    single.nitsche.single_loop = true;
    const Mu mu{1.2, 0.18, 0.08};
    const HfSolution cold = HighFidelity(problem, {}).solve(mu), from_afar = warm.solve(mu),
                     other = HighFidelity(problem, single).solve(mu);
    EXPECT_LT((from_afar.u - cold.u).norm(), 1e-9 * cold.u.norm());
    EXPECT_LT((other.u - cold.u).norm(), 1e-9 * cold.u.norm());
  }
}

TEST(LargeNitsche, AShiftedSupportIsTheMirrorImageOfOneShiftedTheOtherWay) {
  const Scene scene = coarse_disk("coulomb");
  const HfSolution right = solve(scene, {0.8, 0.15, 0.06}), left = solve(scene, {0.8, 0.15, -0.06});
  const Index n = right.lambda.size() / 2;
  EXPECT_LT((right.lambda.head(n) - left.lambda.head(n).reverse()).norm(),
            1e-9 * right.lambda.norm());
  EXPECT_LT((right.lambda.tail(n) + left.lambda.tail(n).reverse()).norm(),
            1e-9 * right.lambda.norm());
}

TEST(LargeNitsche, OneSolveIsTheSameOnAnyNumberOfRanks) {
  for (const char *friction : {"none", "coulomb"}) {
    const Scene scene = coarse_disk(friction);
    const HfSolution all = solve(PETSC_COMM_WORLD, scene, {1, 0.15, 0.05}),
                     own = solve(scene, {1, 0.15, 0.05});
    EXPECT_LT((all.u - own.u).norm(), 1e-9 * own.u.norm());
    EXPECT_LT((all.lambda - own.lambda).norm(), 1e-8 * own.lambda.norm());
  }
}

// It pushes where the body is: the small-deformation answer is off by far more than the mesh.
TEST(LargeNitsche, ContactReachesTheEndOfTheArcWhereItIsTooDeep) {
  const HfSolution s = solve(coarse_disk("none"), {0.7, 0.35, 0.3});
  EXPECT_GT(*s.outputs.ends_in_contact, 0);
}

TEST(LargeNitsche, BoundsOfTheNodesAreForContactAtRest) {
  HfOptions options;
  options.nitsche.nonpenetration = true;
  EXPECT_THROW(solve(coarse_disk("none"), {1, 0.1, 0}, options), Error);
}

} // namespace
} // namespace rbvi::large_nitsche_test
