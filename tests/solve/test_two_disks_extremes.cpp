// Two disks at the ends of what can happen: no contact, contact everywhere, other multipliers and
// other quadrature. Each rank solves for itself, but where nothing touches.
#include "rbvi/solve/high_fidelity.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace rbvi::two_disks_extremes_test {
namespace {

HfSolution solve(const Mu &mu, const SceneOptions &scene, const HfOptions &options = {},
                 MPI_Comm comm = PETSC_COMM_SELF) {
  Problem problem(comm, make_scene("two_disks", scene), {});
  return HighFidelity(problem, options).solve(mu);
}

void expect_finite(const HfSolution &s) {
  EXPECT_TRUE(s.u.allFinite());
  EXPECT_TRUE(s.lambda.allFinite());
  EXPECT_TRUE(std::isfinite(s.kkt.largest()));
  for (const auto output :
       {s.outputs.energy, s.outputs.normal_force, s.outputs.contact_measure,
        s.outputs.peak_pressure, s.outputs.kkt_residual, s.outputs.max_penetration}) {
    ASSERT_TRUE(output);
    EXPECT_TRUE(std::isfinite(*output));
  }
}

/// Each disk moves as a whole: w = 0.
TEST(DisksApart, NothingIsPressed) {
  for (const HfMethod method : {HfMethod::active_set, HfMethod::uzawa})
    for (const std::string multiplier : {"p0", "p1"}) {
      HfOptions options;
      options.method = method;
      const HfSolution s = solve({0.7}, {{"initial_gap", "0.5"}, {"multiplier", multiplier}},
                                 options, PETSC_COMM_WORLD);
      expect_finite(s);
      EXPECT_EQ(s.u.norm(), 0);
      EXPECT_EQ(s.lambda.norm(), 0);
      EXPECT_TRUE(s.active.empty());
      EXPECT_EQ(*s.outputs.energy, 0);
      EXPECT_EQ(*s.outputs.normal_force, 0);
      EXPECT_EQ(*s.outputs.contact_measure, 0);
      EXPECT_EQ(*s.outputs.max_penetration, 0);
      EXPECT_EQ(s.kkt.largest(), 0);
    }
}

TEST(DisksApart, TouchingBeginsAtTheAxis) {
  // 2 * 0.09 of approach against the gap.
  EXPECT_TRUE(solve({1}, {{"initial_gap", "0.1800001"}}).active.empty());
  const HfSolution s = solve({1}, {{"initial_gap", "0.1799"}});
  expect_finite(s);
  ASSERT_FALSE(s.active.empty());
  EXPECT_EQ(s.active.front(), 0);
  EXPECT_EQ(static_cast<std::size_t>(s.active.back()), s.active.size() - 1) << "one interval";
  EXPECT_LT(s.active.size(), 30U);
}

/// Pressed so far that the whole arc is in contact: every multiplier that has a partner. Under the
/// corner where an arc ends the pressure is singular, and a linear one oscillates there.
TEST(DisksFullyPressed, EveryMultiplierWithAPartnerIsActive) {
  for (const std::string multiplier : {"p0", "p1"})
    for (const double radius : {0.7, 1.0, 1.3}) {
      SCOPED_TRACE(multiplier + " " + std::to_string(radius));
      Scene scene = make_scene("two_disks", {{"multiplier", multiplier}});
      scene.motion = [](const FullMu &, const Point &x) -> Point {
        return {0, x[1] > 0 ? -1.0 : 1.0, 0};
      };
      Problem problem(PETSC_COMM_SELF, scene, {});
      const HfSolution s = HighFidelity(problem, {}).solve({radius});
      expect_finite(s);
      EXPECT_LE(s.kkt.largest(), 1e-10);
      const Operators &op = problem.assemble({radius});
      std::vector<Index> paired;
      for (Index i = 0; i < op.weights.size(); ++i)
        if (op.weights[i] > 0) paired.push_back(i);
      const bool linear = multiplier == "p1";
      EXPECT_GE(s.active.size() + (linear ? 1 : 0), paired.size());
      const std::size_t sure = paired.size() - (linear ? 2 : 0);
      ASSERT_GE(s.active.size(), sure);
      EXPECT_TRUE(std::equal(s.active.begin(), s.active.begin() + static_cast<Index>(sure),
                             paired.begin()));
    }
}

struct Discretisation {
  const char *multiplier, *integration;
};

/// The four discretisations of each degree solve one problem: they agree as well as each agrees
/// with its limit. Two points on edges of degree 2, four times as long, see the kinks of the master
/// less well.
void expect_agreement(const std::string &degree, double tolerance) {
  for (const double radius : {0.7, 1.3}) {
    const HfSolution lac = solve({radius}, {{"degree", degree}});
    for (const Discretisation d :
         {Discretisation{"p1", "intersection"}, Discretisation{"p0", "direct"},
          Discretisation{"p1", "direct"}}) {
      SCOPED_TRACE(std::string(d.multiplier) + " " + d.integration + " " + std::to_string(radius));
      const HfSolution s =
          solve({radius},
                {{"degree", degree}, {"multiplier", d.multiplier}, {"integration", d.integration}});
      expect_finite(s);
      EXPECT_LE(s.kkt.largest(), 1e-10);
      EXPECT_NEAR(*s.outputs.normal_force, *lac.outputs.normal_force,
                  tolerance * *lac.outputs.normal_force);
      EXPECT_NEAR(*s.outputs.energy, *lac.outputs.energy, tolerance * *lac.outputs.energy);
      EXPECT_NEAR(*s.outputs.contact_measure, *lac.outputs.contact_measure, 0.01);
    }
  }
}

TEST(DiskDiscretisations, Agree) {
  expect_agreement("1", 1e-4);
  expect_agreement("2", 2e-4);
}

/// Along the contact of disks with meshes that do not match, pressures of neighbours do not jump.
TEST(DiskDiscretisations, PressuresAreSmooth) {
  for (const std::string multiplier : {"p0", "p1"}) {
    const HfSolution s = solve({0.83}, {{"multiplier", multiplier}});
    const double peak = *s.outputs.peak_pressure;
    for (std::size_t k = 1; k + 4 < s.active.size(); ++k)
      EXPECT_NEAR(s.lambda[s.active[k]], s.lambda[s.active[k - 1]], 0.05 * peak);
  }
}

} // namespace
} // namespace rbvi::two_disks_extremes_test
