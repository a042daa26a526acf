// Obstacles above and below a membrane, both at once, the term of order zero, and slopes in
// outputs.
#include "reduced.hpp"

#include "rbvi/model/online.hpp"
#include "rbvi/scene/case.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::obstacles_test {
namespace {

using testing_reduced::Reduced;

Scene scene_of(const std::string &text) {
  return make_scene(read_case("rbvi: 1\nphysics: membrane\n" + text, "case.yaml"), {});
}

double named(const Outputs &outputs, const std::string &name) {
  return std::ranges::find(outputs.named, name, &NamedOutput::name)->value;
}

std::string square(const std::string &degree) {
  return "mesh: {built_in: square_with_disc, edges: 24, degree: " + degree + "}\n";
}

TEST(Obstacles, ABelowIsAnAboveUpsideDown) {
  for (const std::string degree : {"1", "2"})
    for (const std::string more : {"lumped: yes", "lumped: no", "lumped: no, adhesion: 1"}) {
      SCOPED_TRACE(degree + more);
      const auto one = [&](const std::string &load, const std::string &side) {
        return scene_of(
            square(degree) +
            "parameters: {height: {range: [0.01, 0.2], default: 0.1}}\n"
            "loads: {weight: {at: all, force: '" +
            load + "'}}\nimposed: {frame: {at: boundary, u: 0}}\ncontact: {it: {at: obstacle, " +
            side + ", " + more +
            "}}\noutputs: {hold: {reaction: [1, 0], at: boundary}, lean: {integral: slope_x, "
            "in: obstacle}}\n");
      };
      Problem upper(PETSC_COMM_WORLD, one("25 + x", "below: 'height*(1 - x^2)'"), {}),
          lower(PETSC_COMM_WORLD, one("-25 - x", "above: '-height*(1 - x^2)'"), {});
      const HfSolution up = HighFidelity(upper, {}).solve({0.1}),
                       down = HighFidelity(lower, {}).solve({0.1});
      EXPECT_GT(*up.outputs.contact_nodes, 5);
      EXPECT_LT((up.u + down.u).norm(), 1e-12 * up.u.norm());
      EXPECT_NEAR(*up.outputs.normal_force, *down.outputs.normal_force, 1e-11);
      EXPECT_NEAR(*up.outputs.energy, *down.outputs.energy, 1e-11);
      for (const char *name : {"hold", "lean"})
        EXPECT_NEAR(named(up.outputs, name), -named(down.outputs, name), 1e-11) << name;
    }
}

/// A load that turns its sign lifts the membrane to one obstacle and presses it on the other.
const std::string both =
    "parameters: {width: {range: [0.02, 0.05], default: 0.03}}\n"
    "loads: {wind: {at: all, force: '200*x'}}\nimposed: {frame: {at: boundary, u: 0}}\n"
    "contact: {floor: {at: obstacle, above: -width}, ceiling: {at: obstacle, below: width}}\n"
    "outputs: {top: {max: u, in: obstacle}, bottom: {min: u, in: obstacle}, hold: {reaction: [1, "
    "0], "
    "at: boundary}}\n";

TEST(Obstacles, BothHoldFromBothSides) {
  Problem problem(PETSC_COMM_WORLD, scene_of(square("1") + both), {});
  HfOptions eliminated, vi, uzawa;
  eliminated.contact = HfContact::eliminated;
  vi.method = HfMethod::vi;
  uzawa.method = HfMethod::uzawa;
  uzawa.uzawa = {.tolerance = 1e-12, .max_iterations = 100000, .accelerated = true};
  const HfSolution found = HighFidelity(problem, {}).solve({0.03});
  EXPECT_NEAR(named(found.outputs, "top"), 0.03, 1e-12);
  EXPECT_NEAR(named(found.outputs, "bottom"), -0.03, 1e-12);
  ASSERT_EQ(found.outputs.interfaces.size(), 2U);
  const double floor = *found.outputs.interfaces[0].normal_force,
               ceiling = *found.outputs.interfaces[1].normal_force;
  EXPECT_GT(floor, 1);
  EXPECT_NEAR(floor, ceiling, 0.02 * floor) << "but for the mesh";
  EXPECT_NEAR(named(found.outputs, "hold") + floor - ceiling, 0, 1e-10);
  for (const HfOptions &options : {eliminated, vi, uzawa}) {
    const HfSolution other = HighFidelity(problem, options).solve({0.03});
    EXPECT_LT((other.u - found.u).norm(), 1e-7 * found.u.norm());
  }
}

TEST(Obstacles, BothAreReduced) {
  for (const std::string zeroth : {"", "zeroth: 2*width*(1 + x)\n"}) {
    Reduced made(scene_of(square("1") + both + zeroth), "grid:9");
    made.reduce(testing_reduced::everything());
    HighFidelity solver(made.problem, {});
    OnlineSolver online(made.model);
    for (const Mu &mu : {Mu{0.0231}, Mu{0.0444}}) {
      const Outputs full = solver.solve(mu).outputs, found = online.outputs(mu, online.solve(mu));
      EXPECT_NEAR(*found.normal_force, *full.normal_force, 2e-3 * *full.normal_force) << zeroth;
      EXPECT_NEAR(*found.energy, *full.energy, 1e-3 * std::abs(*full.energy)) << zeroth;
    }
  }
}

/// A string over a parabola, as a strip: the pressure is the curvature, 2, where they touch, over a
/// width of 1 - 2 sqrt(1/4 - height); the strip is 1/2 wide.
Scene strip(const std::string &degree, const std::string &more) {
  return scene_of("mesh: {built_in: two_blocks, degree: " + degree +
                  "}\nparameters: {height: {range: [0.08, 0.15], default: 0.1}}\n"
                  "imposed: {ends: {at: sides, u: 0}}\n"
                  "contact: {it: {at: upper, above: height - (x - 1/2)^2" +
                  more +
                  "}}\noutputs: {push: {integral: pressure}, width: {measure: contact}, peak: "
                  "{max: pressure}, arm: {integral: pressure*x}, inner: {mean: pressure, where: "
                  "'abs(x - 1/2) < 0.04'}, open: {max: gap}, least: {min: gap}, touched: {mean: u, "
                  "where: contact}, ground: {mean: height - (x - 1/2)^2, where: contact}}\n");
}

TEST(Obstacles, OutputsOverTheirRegions) {
  for (const std::string degree : {"1", "2"})
    for (const std::string more : {"", ", lumped: no, adhesion: 0.3"}) {
      SCOPED_TRACE(degree + more);
      Problem problem(PETSC_COMM_WORLD, strip(degree, more), {.refine = 3});
      const Outputs found = HighFidelity(problem, {}).solve({0.1}).outputs;
      const double push = *found.normal_force;
      EXPECT_NEAR(named(found, "push"), push, 1e-12 * push);
      EXPECT_NEAR(named(found, "peak"), *found.peak_pressure, 1e-12 * push);
      EXPECT_NEAR(named(found, "arm"), push / 2, 2e-3 * push) << "but for the triangles";
      EXPECT_NEAR(named(found, "touched"), named(found, "ground"), 1e-3 * 0.1);
      EXPECT_GT(named(found, "open"), 0.05);
      EXPECT_NEAR(named(found, "least"), 0, 2e-3 * 0.1) << "between the nodes";
      if (!more.empty()) continue;
      EXPECT_NEAR(named(found, "inner"), 2, 1e-2);
      EXPECT_NEAR(named(found, "width"), (1 - 2 * std::sqrt(0.25 - 0.1)) / 2, 0.01)
          << "half an edge at both ends";
    }
}

TEST(Obstacles, OutputsOverTheirRegionsAreReduced) {
  Reduced made(strip("1", ""), "grid:12");
  made.reduce(testing_reduced::everything());
  HighFidelity solver(made.problem, {});
  OnlineSolver online(made.model);
  for (const Mu &mu : {Mu{0.0873}, Mu{0.1281}}) {
    const Outputs full = solver.solve(mu).outputs, found = online.outputs(mu, online.solve(mu));
    for (const char *name : {"push", "peak", "arm", "open", "touched"})
      EXPECT_NEAR(named(found, name), named(full, name), 1e-2 * std::abs(named(full, name)))
          << name;
  }
}

/// As a number, a parameter, a function of the point, and on a mapped domain: -Laplace u + c u = f
/// on 2 times the square is -Laplace v + 4 c v = 4 f on the square.
TEST(Zeroth, IsTheSameHoweverItIsWritten) {
  const auto solved = [](const std::string &zeroth, const std::string &load,
                         const std::string &map) {
    Problem problem(
        PETSC_COMM_WORLD,
        scene_of(
            square("2") + map + "zeroth: '" + zeroth +
            "'\nparameters: {k: {range: [1, 20], default: 16}, s: {range: [0.5, 3], default: 2}}\n"
            "loads: {one: {at: all, force: " +
            load +
            "}}\nimposed: {frame: {at: boundary, u: 0}}\n"
            "contact: {far: {at: obstacle, above: 0.05}}\n"),
        {});
    const HfSolution found = HighFidelity(problem, {}).solve({16, 2});
    EXPECT_GT(*found.outputs.normal_force, 0);
    return found.u;
  };
  const Vector u = solved("16 + 0*k*s", "-12", "");
  for (const std::string c : {"k + 0*s", "k + 0*x*s", "8*s + 0*k"})
    EXPECT_LT((solved(c, "-12", "") - u).norm(), 1e-11 * u.norm()) << c;
  EXPECT_LT((solved("k/4", "-3", "map: {scale: s}\n") - u).norm(), 1e-11 * u.norm());
}

TEST(Zeroth, HoldsAMembraneThatNothingElseHolds) {
  // u = load / c everywhere.
  Problem problem(
      PETSC_COMM_WORLD,
      scene_of(square("1") +
               "zeroth: 1 + rate\nparameters: {rate: {range: [1, 3], default: 2}}\n"
               "loads: {one: {at: all, force: 6}}\ncontact: {far: {at: obstacle, above: 0}}\n"),
      {});
  const HfSolution found = HighFidelity(problem, {}).solve({2});
  EXPECT_LT((found.u.array() - 2).abs().maxCoeff(), 1e-12);
  EXPECT_NEAR(*found.outputs.energy, -6, 1e-11);
}

TEST(Zeroth, IsRefusedWhereItMakesNoSense) {
  const std::string rest = square("1") + "parameters: {p: {range: [1, 2], default: 1}}\n"
                                         "contact: {on: {at: obstacle, above: 0}}\n";
  EXPECT_THROW(scene_of(rest + "zeroth: -1\n"), Error);
  for (const char *negative : {"x < 0 ? -30 : 1", "p - 3", "1 + p - 9*x"}) {
    const auto assembled = [&] {
      Problem(PETSC_COMM_WORLD, scene_of(rest + "zeroth: '" + negative + "'\n"), {}).assemble({1});
    };
    EXPECT_THROW(assembled(), Error) << negative;
  }
  EXPECT_THROW(scene_of(square("1") + "parameters: {p: {range: [1, 2], default: 1}}\n"
                                      "contact: {on: {at: obstacle, above: 0, below: 1}}\n"),
               Error);
}

} // namespace
} // namespace rbvi::obstacles_test
