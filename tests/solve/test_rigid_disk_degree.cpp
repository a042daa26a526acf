// The rigid disk with displacements of degree 1: against those of degree 2 on finer and finer
// meshes, under every law of friction, by multipliers and by Nitsche's method.
#include "rbvi/solve/high_fidelity.hpp"
#include "rbvi/solve/methods.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

namespace rbvi::rigid_disk_degree_test {
namespace {

/// At radius 1 m and indentation 0.09 m.
Outputs answer(SceneOptions options, const std::string &degree, int refine) {
  options["degree"] = degree;
  options.try_emplace("arc_edges", "40");
  Problem problem(PETSC_COMM_WORLD, make_scene("rigid_disk", options), {"", refine});
  const HfSolution s = HighFidelity(problem, {}).solve({1});
  if (has_multipliers(problem.scene())) {
    EXPECT_LE(s.kkt.largest(), 1e-12);
  }
  return s.outputs;
}

/// The energy, of second order (3.3 to 3.9 times less on half the edges); the force follows it.
void expect_convergence(const SceneOptions &options) {
  const Outputs fine = answer(options, "2", 1);
  const Outputs once = answer(options, "1", 0), twice = answer(options, "1", 1);
  const double before = *once.energy - *fine.energy, after = *twice.energy - *fine.energy;
  EXPECT_GT(before, 3 * after);
  EXPECT_LT(before, 4.5 * after);
  EXPECT_GT(after, 0) << "a coarser space is stiffer";
  EXPECT_LT(after, 5e-3 * *fine.energy);
  EXPECT_NEAR(*twice.normal_force, *fine.normal_force, 5e-3 * *fine.normal_force);
}

TEST(RigidDiskOfDegreeOne, ConvergesToDegreeTwo) {
  for (const char *kinematics : {"small", "large"})
    for (const char *friction : {"none", "tresca", "coulomb"}) {
      SCOPED_TRACE(std::string(kinematics) + " " + friction);
      expect_convergence({{"kinematics", kinematics}, {"friction", friction}});
    }
}

TEST(RigidDiskOfDegreeOne, ConvergesByNitschesMethod) {
  for (const char *kinematics : {"small", "large"}) {
    SCOPED_TRACE(kinematics);
    expect_convergence(
        {{"kinematics", kinematics}, {"friction", "coulomb"}, {"formulation", "nitsche"}});
  }
}

} // namespace
} // namespace rbvi::rigid_disk_degree_test
