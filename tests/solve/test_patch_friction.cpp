// The patch test with Coulomb friction: one block on a flat support carries a constant stress
// exactly, whether its foot sticks or slips, of degree 1 and 2.
#include "block_on_support.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::patch_friction_test {
namespace {

using namespace block_on_support;

/// Without friction the scene has no coefficient, the last of `mu`.
void expect_exact(const Scene &scene, const Mu &mu, bool frictionless = false) {
  const Mu free(mu.begin(), mu.begin() + scene.parameters.size());
  SCOPED_TRACE(describe(scene.parameters, free));
  Problem problem(PETSC_COMM_WORLD, scene, {});
  const HfSolution s = HighFidelity(problem, {}).solve(free);
  const Exact exact(mu, frictionless);
  const Index count = problem.contact().nodes();
  EXPECT_LE((s.lambda.head(count).array() - exact.pressure).abs().maxCoeff(),
            1e-12 * exact.pressure);
  if (!frictionless) {
    EXPECT_LE((s.lambda.tail(count).array() - exact.stress).abs().maxCoeff(),
              1e-12 * exact.pressure);
  }
  EXPECT_LE(displacement_error(problem, mu, exact, s), 1e-12 * mu[0]);
  EXPECT_LE(s.kkt.largest(), 1e-12);
  EXPECT_NEAR(*s.outputs.normal_force, exact.pressure, 1e-12 * exact.pressure);
  EXPECT_NEAR(*s.outputs.reaction, exact.pressure, 1e-12 * exact.pressure);
  EXPECT_NEAR(*s.outputs.peak_pressure, exact.pressure, 1e-12 * exact.pressure);
  EXPECT_NEAR(*s.outputs.centre_pressure, exact.pressure, 1e-11 * exact.pressure);
  EXPECT_NEAR(*s.outputs.contact_half_width, 0.5, 1e-13);
  EXPECT_FALSE(s.outputs.ends_in_contact) << "the block ends with its foot";
}

TEST(PatchFriction, AFootThatSticksIsExact) {
  for (const std::string degree : {"1", "2"}) {
    expect_exact(block(degree), {0.05, 0.02, 0.3});
    expect_exact(block(degree), {0.01, 0.0, 0.5});
    expect_exact(block(degree), {0.1, 0.19, 1});
  }
}

TEST(PatchFriction, AFootThatSlipsIsExact) {
  for (const std::string degree : {"1", "2"}) {
    expect_exact(block(degree), {0.05, 0.2, 0.3});
    expect_exact(block(degree), {0.02, 0.1, 0.01});
  }
}

TEST(PatchFriction, WithoutFrictionTheFootSlidesFreely) {
  for (const std::string degree : {"1", "2"}) {
    expect_exact(block(degree, "none"), {0.05, 0.1, 0.3}, true);
    expect_exact(block(degree), {0.05, 0.1, 0});
  }
}

/// With a large coefficient the foot sticks in part, or more of it does.
TEST(PatchFriction, ALargeCoefficientHasAnswersThatAreLookedFor) {
  Problem problem(PETSC_COMM_WORLD, block("1"), {});
  HfOptions options;
  const auto to_other = [&](const Mu &mu) {
    return HighFidelity(problem, options).solve(mu).to_other;
  };
  const Mu several{0.01, 0.2, 2.868};
  EXPECT_EQ(to_other(several), 0) << "not asked for";
  options.looks_for_others = true;
  EXPECT_GT(to_other(several), 0.1);
  EXPECT_EQ(to_other({0.05, 0.02, 0.3}), 0);
}

TEST(PatchFriction, UzawaFindsTheSame) {
  for (const Mu &mu : {Mu{0.05, 0.02, 0.3}, Mu{0.05, 0.2, 0.3}}) {
    Problem problem(PETSC_COMM_SELF, block("1"), {});
    HfOptions options;
    options.method = HfMethod::uzawa;
    options.uzawa.tolerance = 1e-11;
    const HfSolution s = HighFidelity(problem, options).solve(mu);
    const Exact exact(mu, false);
    const Index count = problem.contact().nodes();
    EXPECT_LE((s.lambda.head(count).array() - exact.pressure).abs().maxCoeff(),
              1e-6 * exact.pressure);
    EXPECT_LE((s.lambda.tail(count).array() - exact.stress).abs().maxCoeff(),
              1e-6 * exact.pressure);
  }
}

} // namespace
} // namespace rbvi::patch_friction_test
