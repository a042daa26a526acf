// All forces on a body as outputs print them: they balance where every kind of term acts, and a
// wrong one is named with the body.
#include "rbvi/core/error.hpp"
#include "rbvi/fem/body_balance.hpp"
#include "rbvi/scene/case.hpp"
#include "rbvi/solve/high_fidelity.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::body_balance_test {
namespace {

Scene scene_of(const std::string &text) {
  return make_scene(read_case("rbvi: 1\n"
                              "parameters: {d: {range: [0.02, 0.1], default: 0.05}}\n" +
                                  text,
                              "case.yaml"),
                    {});
}

/// What is left of each sum over its sizes, and how many there are.
std::vector<double> shares_left(Problem &problem, const Mu &mu, const Outputs &outputs) {
  std::vector<double> shares;
  for (const BodyForces &forces :
       forces_on_bodies(problem, expand(problem.scene().parameters, mu))) {
    const auto [left, sizes] = left_of(forces, outputs);
    shares.push_back(std::abs(left) / sizes);
  }
  return shares;
}

/// The sums of a case balance, so many of them; one force that is a thousandth off is refused.
void expect_balance(const Scene &scene, std::size_t sums, const std::string &named) {
  Problem problem(PETSC_COMM_WORLD, scene, {});
  const Mu mu{0.047};
  const HfSolution s = HighFidelity(problem, {}).solve(mu);
  const std::vector<double> shares = shares_left(problem, mu, s.outputs);
  EXPECT_EQ(shares.size(), sums);
  for (const double share : shares)
    EXPECT_LT(share, 1e-12);
  const FullMu all = expand(problem.scene().parameters, mu);
  check_balance(problem, all, s.outputs, 1e-10, 0);
  Outputs wrong = s.outputs;
  const auto output = std::ranges::find(wrong.named, named, &NamedOutput::name);
  ASSERT_NE(output, wrong.named.end());
  EXPECT_GT(std::abs(output->value), 1e-3);
  output->value *= 1.001;
  try {
    check_balance(problem, all, wrong, 1e-10, 0);
    ADD_FAILURE() << "a wrong " << named << " passes";
  } catch (const Error &error) {
    EXPECT_EQ(std::string(error.what()).find("the forces on the body of the boundary"), 0U)
        << error.what();
  }
}

/// One block with a map, imposed values, a motion, loads on cells and edges, a thermal strain, a
/// spring and two contacts.
TEST(BodyBalance, HoldsWhereEverythingActs) {
  const Scene scene = scene_of(
      "physics: plane_strain\nmesh: {built_in: one_block, degree: 2}\nmap: [1.2*x, 1.1*y]\n"
      "materials: {rubber: {at: all, E: 15, nu: 0.3, expansion: 0.01, temperature: 20*d}}\n"
      "motion: [0, -d]\nimposed: {top: {at: top, ux: -0.3*d*x, uy: motion}}\n"
      "loads:\n  weight: {at: all, force: [0, -2*d]}\n  edge: {at: top, traction: [0.5, 0]}\n"
      "  sides: {at: sides, pressure: 0.2*d}\n"
      "springs: {bolt: {at: contact, direction: [1, 0], stiffness: 3, pretension: d}}\n"
      "contact:\n  floor: {at: contact, against: {plane: {normal: [0, -1], position: 0}}, "
      "friction: {coulomb: 0.4}}\n"
      "  wall: {at: sides, against: {plane: {normal: [1, 0], position: 1.2 - 0.1*d}}}\n"
      "outputs:\n  up: {reaction: [0, 1], at: top}\n  aside: {reaction: [1, 0], at: top}\n"
      "  bolt: {spring: bolt}\n");
  expect_balance(scene, 2, "up");
  expect_balance(scene, 2, "bolt");
}

/// Two bodies on two boundaries each, in rows of both: one pushes the other.
std::string joint(const std::string &symmetry, const std::string &outputs) {
  return "physics: plane_strain\nmesh: {built_in: two_blocks, degree: 2}\n" + symmetry +
         "map: [x, 'y > 0 ? y - 0.25 : y + 0.25']\n"
         "materials: {rubber: {at: all, E: 15, nu: 0.35}}\n"
         "imposed: {top: {at: top, ux: 0, uy: -d}, bottom: {at: bottom, ux: 0, uy: 0}}\n"
         "loads: {side: {at: sides, traction: [0.1*x, d]}}\n"
         "contact: {faces: {at: slave, against: master, friction: {coulomb: 0.3}}}\n"
         "outputs:\n" +
         outputs;
}

TEST(BodyBalance, IsThatOfEachOfTwoBodies) {
  const std::string vertical =
      "  up: {reaction: [0, 1], at: top}\n  down: {reaction: [0, -1], at: bottom}\n";
  expect_balance(scene_of(joint("", vertical)), 2, "down");
  expect_balance(scene_of(joint("", vertical + "  aside: {reaction: [1, 0], at: top}\n")), 3, "up");
  expect_balance(scene_of(joint("", "  oblique: {reaction: [0.6, 0.8], at: top}\n")), 1, "oblique");
}

/// What no output has is not known, and nothing is said.
TEST(BodyBalance, OfUnknownForcesThereIsNone) {
  Problem problem(PETSC_COMM_WORLD, scene_of(joint("", "  wide: {mean: ux, at: top}\n")), {});
  EXPECT_TRUE(forces_on_bodies(problem, expand(problem.scene().parameters, {0.05})).empty());
}

/// Held in two places, of whose rows both reactions are.
const std::string beam =
    "physics: PHYSICS\nmesh: {built_in: one_block, degree: 2}\nMIRROR"
    "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
    "imposed: {top: {at: top, uy: -d}, axis: {at: sides, ux: 0}}\n"
    "loads: {weight: {at: all, force: [0, -d]}}\n"
    "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], position: 0}}"
    "FORMULATION}}\noutputs: {up: {reaction: [0, 1], at: top}}\n";

std::string with(std::string text, const std::string &key, const std::string &value) {
  return text.replace(text.find(key), key.size(), value);
}

TEST(BodyBalance, IsOfTheWholeOfHalfModelsAndTurnedBodiesAndByNitsche) {
  for (const std::string physics : {"plane_strain", "axisymmetric"})
    for (const std::string mirror : {"", "mirror: {x: 0}\n"})
      for (const std::string formulation : {"", ", formulation: nitsche"}) {
        if (physics == "axisymmetric" && !mirror.empty()) continue;
        SCOPED_TRACE(physics + mirror + formulation);
        expect_balance(scene_of(with(with(with(beam, "PHYSICS", physics), "MIRROR", mirror),
                                     "FORMULATION", formulation)),
                       1, "up");
      }
}

} // namespace
} // namespace rbvi::body_balance_test
