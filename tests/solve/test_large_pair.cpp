// Two deformed bodies: known values, work and energy, and a patch test with a finite motion.
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/solve/high_fidelity.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rbvi::large_pair_test {
namespace {

HfSolution solve(const Scene &scene, const Mu &mu, const HfOptions &options = {}) {
  Problem problem(PETSC_COMM_WORLD, scene, {});
  return HighFidelity(problem, options).solve(mu);
}

Scene disks(const std::string &indentation, SceneOptions options = {}) {
  options["kinematics"] = "large";
  options["indentation"] = indentation;
  return make_scene("two_disks", options);
}

// Of equal disks the interface stays flat: values of another code, extrapolated.
TEST(LargeDeformationsOfTwo, EqualDisksAgreeWithTheKnownValues) {
  struct Known {
    const char *d;
    double energy, force, half_width, peak;
  };
  for (const Known &k : {Known{"0.03", 0.00822346, 0.308296, 0.1505, 1.30532},
                         Known{"0.09", 0.0993350, 1.267026, 0.2991, 2.70711}}) {
    const HfSolution s = solve(disks(k.d), {1});
    EXPECT_NEAR(*s.outputs.energy, k.energy, 2e-4 * k.energy);
    EXPECT_NEAR(*s.outputs.normal_force, k.force, 2e-4 * k.force);
    EXPECT_NEAR(*s.outputs.reaction, k.force, 2e-4 * k.force);
    EXPECT_NEAR(*s.outputs.peak_pressure, k.peak, 1e-3 * k.peak);
    EXPECT_NEAR(*s.outputs.contact_measure, k.half_width * 2, 0.012);
  }
}

TEST(LargeDeformationsOfTwo, NewtonAndKacanovTakeFewSteps) {
  Problem problem(PETSC_COMM_WORLD, disks("0.09"), {});
  for (const double radius : {0.7, 1.0, 1.3}) {
    HfOptions options;
    options.nonlinear.tolerance = 1e-8;
    const HfSolution newton = HighFidelity(problem, options).solve({radius});
    EXPECT_LE(newton.iterations, 8);
    for (const auto &[method, most] :
         {std::pair{NonlinearMethod::kacanov, 25}, std::pair{NonlinearMethod::anderson, 14}}) {
      options.nonlinear.method = method;
      const HfSolution other = HighFidelity(problem, options).solve({radius});
      EXPECT_LE(other.iterations, most);
      EXPECT_LT((other.lambda - newton.lambda).norm(), 1e-6 * newton.lambda.norm());
    }
  }
}

// Both flat sides move by d: dJ/dd is twice the force on one of them.
TEST(LargeDeformationsOfTwo, TheReactionIsTheDerivativeOfTheEnergy) {
  const double h = 1e-4;
  const SceneOptions coarse{{"arc_edges", "40"}};
  for (const double radius : {0.74, 1.2}) {
    const auto at = [&](double d) { return solve(disks(std::to_string(d), coarse), {radius}); };
    const double slope = (*at(0.06 + h).outputs.energy - *at(0.06 - h).outputs.energy) / (2 * h);
    EXPECT_NEAR(slope, 2 * *at(0.06).outputs.reaction, 1e-6 * slope);
  }
}

TEST(LargeDeformationsOfTwo, EveryMultiplierAndDegreeConverges) {
  for (const char *degree : {"1", "2"})
    for (const char *multiplier : {"p0", "p1"}) {
      const HfSolution s = solve(
          disks("0.09", {{"degree", degree}, {"multiplier", multiplier}, {"arc_edges", "60"}}),
          {0.8});
      EXPECT_LE(s.kkt.largest(), 1e-10);
      EXPECT_NEAR(*s.outputs.normal_force, 1.304, 0.02);
    }
}

TEST(LargeDeformationsOfTwo, OneSolveIsTheSameOnAnyNumberOfRanks) {
  const Scene scene = disks("0.09", {{"arc_edges", "40"}});
  const HfSolution all = solve(scene, {0.8});
  Problem problem(PETSC_COMM_SELF, scene, {});
  const HfSolution own = HighFidelity(problem, {}).solve({0.8});
  EXPECT_LT((all.u - own.u).norm(), 1e-9 * own.u.norm());
  EXPECT_LT((all.lambda - own.lambda).norm(), 1e-9 * own.lambda.norm());
}

/// A lower disk so small that contact comes to the end of its arc.
Scene small_lower_disk(const std::string &initial_gap) {
  Scene scene = disks("0.1", {{"initial_gap", initial_gap}, {"arc_edges", "70"}});
  scene.parameters.all[0].lower = 0.5;
  return scene;
}

TEST(LargeDeformationsOfTwo, ContactAtTheEndOfTheLowerArcIsCounted) {
  EXPECT_EQ(*solve(small_lower_disk("-0.1"), {0.5}).outputs.ends_in_contact, 0);
  // That of the domain and its mirror image.
  EXPECT_EQ(*solve(small_lower_disk("-0.17"), {0.5}).outputs.ends_in_contact, 2);
}

TEST(LargeDeformationsOfTwo, OfEqualDisksTheInterfaceIsFlat) {
  Problem problem(PETSC_COMM_WORLD, disks("0.09"), {});
  const HfSolution s = HighFidelity(problem, {}).solve({1});
  const ContactInterface &interface = *problem.contact().interfaces.front();
  const InterfaceMesh &mesh = interface.mesh();
  const FullMu all = expand(problem.scene().parameters, {1});
  std::vector<double> heights;
  for (Index i = 0; i < mesh.parts[0]; ++i) { // vertices of the upper arc, then the middles
    const auto node = static_cast<std::size_t>(i);
    const Index edges = s.lambda.size(), edge = i <= edges ? std::min(i, edges - 1) : i - edges - 1;
    const bool carries = s.lambda[edge] > 0 && (i > edges || i == 0 || s.lambda[i - 1] > 0);
    if (!carries) continue;
    const Point motion = problem.scene().motion(all, mesh.points[node]);
    const Point x = problem.scene().map(all, mesh.points[node]);
    const int dof = mesh.dofs[2 * node + 1];
    ASSERT_GE(dof, 0);
    heights.push_back(x[1] + motion[1] + s.states.back()[dof]);
  }
  EXPECT_GT(heights.size(), 80U);
  EXPECT_LT(std::ranges::max(heights) - std::ranges::min(heights), 1e-5);
}

/// Two blocks, all turned by 30 degrees; in the reference the upper one stands 0.3 m aside, and
/// comes over the lower one by its motion, a finite one along the interface. Poisson's ratio is
/// zero, so that nothing moves sideways and the sides are free.
Scene turned_blocks(const char *degree, const char *multiplier) {
  constexpr double young = 15, aside = 0.3;
  Scene scene = make_scene("patch", {{"kinematics", "large"},
                                     {"degree", degree},
                                     {"multiplier", multiplier},
                                     {"poisson_ratio", "0"}});
  const auto turned = [](double x, double y) {
    const double c = std::cos(std::numbers::pi / 6), s = std::sin(std::numbers::pi / 6);
    return Point{c * x - s * y, s * x + c * y, 0};
  };
  scene.map = [turned](const FullMu &, const Point &x) {
    return turned(x[1] > 0 ? x[0] - aside : x[0], x[1] - (x[1] > 0 ? 0.25 : -0.25));
  };
  scene.motion = [turned](const FullMu &mu, const Point &x) {
    return x[1] > 0 ? turned(aside, -mu[0]) : Point{0, 0, 0};
  };
  scene.a = {mapped_term(elasticity("", lame(young, 0), scene.degree))};
  scene.fixed = {{"top", {}}, {"bottom", {}}};
  return scene;
}

TEST(LargeDeformationsOfTwo, PassThePatchTestTurnedAndMovedFar) {
  for (const char *degree : {"1", "2"})
    for (const char *multiplier : {"p0", "p1"})
      for (const double d : {0.02, 0.1}) {
        HfOptions options;
        options.nonlinear.tolerance = 1e-12;
        const HfSolution s = solve(turned_blocks(degree, multiplier), {d}, options);
        EXPECT_LE((s.lambda.array() - 15 * d).abs().maxCoeff(), 1e-11 * 15 * d)
            << degree << ' ' << multiplier;
        EXPECT_NEAR(*s.outputs.energy, 15 * d * d / 2, 1e-12);
        EXPECT_LE(*s.outputs.max_penetration, 1e-12);
      }
}

} // namespace
} // namespace rbvi::large_pair_test
