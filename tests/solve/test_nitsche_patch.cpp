// The patch test by Nitsche's method: one block on a flat support carries a constant stress
// exactly, whether its foot slides, sticks or slips, and as the mixed formulation does.
#include "block_on_support.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/scene/case.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace rbvi::nitsche_patch_test {
namespace {

using namespace block_on_support;

/// `tolerance` is relative.
void expect_exact(const std::string &degree, const std::string &friction, const Mu &mu,
                  double tolerance, const NitscheOptions &options = {}) {
  const bool frictionless = friction == "none";
  const Scene scene = block(degree, friction, "nitsche");
  SCOPED_TRACE(describe(scene.parameters, mu) + ", degree " + degree);
  Problem problem(PETSC_COMM_WORLD, scene, {});
  HfOptions hf;
  hf.nitsche = options;
  const HfSolution s = HighFidelity(problem, hf).solve(mu);
  const Exact exact(mu, frictionless);
  const double near = tolerance * exact.pressure;
  const Index count = frictionless ? s.lambda.size() : s.lambda.size() / 2;
  EXPECT_LE((s.lambda.head(count).array() - exact.pressure).abs().maxCoeff(), near);
  EXPECT_LE(displacement_error(problem, mu, exact, s), tolerance * mu[0]);
  EXPECT_NEAR(*s.outputs.normal_force, exact.pressure, near);
  EXPECT_NEAR(*s.outputs.reaction, exact.pressure, near);
  EXPECT_NEAR(*s.outputs.peak_pressure, exact.pressure, near);
  EXPECT_NEAR(*s.outputs.centre_pressure, exact.pressure, near);
  EXPECT_NEAR(*s.outputs.contact_half_width, 0.5, 1e-13);
  EXPECT_LE(*s.outputs.law_error_normal, tolerance);
  EXPECT_LE(*s.outputs.max_penetration, tolerance * mu[0]);
  EXPECT_LE(s.kkt.largest(), 1e-12);
  if (frictionless) return;
  EXPECT_LE((s.lambda.tail(count).array() - exact.stress).abs().maxCoeff(), near);
  EXPECT_NEAR(*s.outputs.tangential_force, exact.stress, near);
  EXPECT_NEAR(*s.outputs.stick_half_width, exact.slip > 0 ? 0 : 0.5, 1e-13);
  EXPECT_LE(*s.outputs.friction_violation, near);
  EXPECT_LE(*s.outputs.law_error_tau_over_n, tolerance);
}

/// Where cells are flat gamma is too small.
TEST(NitschePatch, AFailureIsNoOthers) {
  const std::string text =
      "rbvi: 1\nphysics: plane_strain\nmesh: {built_in: one_block}\n"
      "parameters: {height: {range: [1e-3, 1], default: 1}}\nmap: [x, height*y]\n"
      "materials: {rubber: {at: all, E: 15, nu: 0.35}}\n"
      "imposed: {sides: {at: sides, ux: 0}, top: {at: top, ux: 0, uy: -0.05*height}}\n"
      "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], position: 0}}, "
      "formulation: nitsche}}\n";
  Problem problem(PETSC_COMM_WORLD, make_scene(read_case(text, "flat.yaml", {}), {}), {});
  HighFidelity solver(problem, {});
  EXPECT_THROW((void)solver.solve({1e-3}), Error);
  EXPECT_NEAR(*solver.solve({1}).outputs.normal_force, 65.0 / 27, 1e-11);
  EXPECT_THROW((void)solver.solve({1e-3}), Error);
}

/// Its sides are loaded, and nothing touches.
TEST(NitschePatch, ALiftedBlockIsSolvedToRoundOff) {
  for (const std::string friction : {"none", "coulomb"}) {
    Scene scene = block("2", friction, "nitsche");
    scene.parameters.all[0].lower = -0.1;
    Problem problem(PETSC_COMM_WORLD, scene, {});
    const HfSolution s = HighFidelity(problem, {}).solve({-0.05, 0.1, 0.3});
    EXPECT_NEAR(*s.outputs.normal_force, 0, 1e-12) << friction;
    EXPECT_LE(s.kkt.largest(), 1e-12) << friction;
  }
}

TEST(NitschePatch, SlidesFreelyWithoutFriction) {
  for (const std::string degree : {"1", "2"})
    expect_exact(degree, "none", {0.05, 0.1, 0.3}, 1e-12);
}
TEST(NitschePatch, AFootThatSticksIsExact) {
  for (const std::string degree : {"1", "2"}) {
    expect_exact(degree, "coulomb", {0.05, 0.02, 0.3}, 1e-12);
    expect_exact(degree, "coulomb", {0.1, 0.19, 1}, 1e-12);
  }
}
/// The loop over Coulomb's bound ends where it changes u by 1e-12, and a change of the bound
/// changes stresses by more than u.
TEST(NitschePatch, AFootThatSlipsIsExact) {
  for (const std::string degree : {"1", "2"}) {
    expect_exact(degree, "coulomb", {0.05, 0.2, 0.3}, 1e-11);
    expect_exact(degree, "coulomb", {0.05, 0.2, 0}, 1e-12);
    expect_exact(degree, "coulomb", {0.02, 0.1, 0.01}, 1e-11);
  }
}

TEST(NitschePatch, BoundsThatFollowEveryStepEndInTheSame) {
  NitscheOptions single;
  single.single_loop = true;
  for (const std::string degree : {"1", "2"}) {
    expect_exact(degree, "coulomb", {0.05, 0.2, 0.3}, 1e-11, single);
    expect_exact(degree, "coulomb", {0.05, 0.02, 0.3}, 1e-11, single);
  }
}

/// On each rank by itself: the mixed formulation takes long on a few dofs that are spread over
/// ranks.
TEST(NitschePatch, AgreesWithTheMixedFormulation) {
  const auto solve = [](const Scene &scene, const Mu &mu) {
    Problem problem(PETSC_COMM_SELF, scene, {});
    return HighFidelity(problem, {}).solve(mu);
  };
  for (const std::string degree : {"1", "2"})
    for (const std::string friction : {"none", "coulomb"})
      for (const double shear : {0.02, 0.2}) {
        const Mu mu{0.05, shear, 0.3};
        const HfSolution s = solve(block(degree, friction, "nitsche"), mu);
        const HfSolution mixed = solve(block(degree, friction), mu);
        EXPECT_NEAR(*s.outputs.energy, *mixed.outputs.energy, 1e-11 * *mixed.outputs.energy);
        EXPECT_LE((s.u - mixed.u).norm(), 1e-11 * mixed.u.norm());
        EXPECT_LE((s.lambda - mixed.lambda).norm(), 1e-11 * mixed.lambda.norm());
      }
}

} // namespace
} // namespace rbvi::nitsche_patch_test
