// Outputs of a case's own: what balances each other, full and reduced.
#include "named_outputs.hpp"

#include "rbvi/model/print.hpp"
#include "rbvi/mor/reduced_balance.hpp"

#include <cmath>
#include <sstream>

namespace rbvi::named_outputs_test {
namespace {

TEST(NamedOutputs, AReactionBalancesContactAndLoads) {
  const std::string hold = "imposed: {top: {at: top, ux: 0.3*d, uy: -d}}\n"
                           "loads: {weight: {at: all, force: [0, -2*d]}, "
                           "edge: {at: top, traction: [0.5, 0]}}\n";
  const std::string outputs = "  up: {reaction: [0, 1], at: top}\n"
                              "  corner: {value: ux, point: [1, 0.5]}\n"
                              "  aside: {reaction: [1, 0], at: top}\n";
  const Mu mu{0.047, 13};
  const auto balance = [&](double area) {
    return [=](std::map<std::string, double> found) {
      EXPECT_NEAR(found["up"] + found["pressed"], 2 * mu[0] * 0.5 * area, 1e-9);
      EXPECT_NEAR(std::abs(found["aside"] + 0.5 * std::sqrt(area)), std::abs(found["sheared"]),
                  1e-9);
      EXPECT_GT(found["pressed"], 0.1);
      EXPECT_NEAR(found["corner"], 0.3 * mu[0], 1e-12);
    };
  };
  compare_balance(pressed(hold, outputs, "plane_strain"), mu, balance(1));
  compare_balance(pressed(hold, outputs, "plane_strain", "map: [1.5*x, 1.5*y]\n"), mu,
                  balance(1.5 * 1.5));
}

TEST(NamedOutputs, ASpringPullsWithWhatContactCarries) {
  const std::string hold = "springs: {bolt: {at: top, stiffness: 3, pretension: 20*d, "
                           "settled: -0.1*d}}\n"
                           "imposed: {sides: {at: sides, ux: 0}}\n";
  compare_balance(
      pressed(hold, "  bolt: {spring: bolt}\n  top: {mean: uy, at: top}\n", "plane_strain"),
      {0.047, 13}, [](std::map<std::string, double> found) {
        EXPECT_NEAR(found["bolt"], found["pressed"], 1e-9);
        EXPECT_NEAR(found["bolt"], 20 * 0.047 + 3 * (found["top"] + 0.0047), 1e-9);
        EXPECT_LT(found["top"], -0.001);
      });
}

/// A case in which every kind of term acts.
Scene everything_acts() {
  const std::string text =
      "rbvi: 1\nphysics: plane_strain\nmesh: {built_in: one_block, degree: 2}\n"
      "map: [1.2*x, 1.1*y]\n"
      "parameters: {d: {range: [0.02, 0.1], default: 0.05}, young: {range: [10, 20], default: "
      "15}}\n"
      "materials: {rubber: {at: all, E: young, nu: 0.3, expansion: 0.01, temperature: 20*d}}\n"
      "motion: [0, -d]\n"
      "imposed: {top: {at: top, ux: -0.3*d*x, uy: motion}}\n"
      "loads:\n  weight: {at: all, force: [0, -2*d]}\n  edge: {at: top, traction: [0.5, 0]}\n"
      "  sides: {at: sides, pressure: 0.2*d}\n"
      "springs: {bolt: {at: contact, direction: [1, 0], stiffness: 3, pretension: d}}\n"
      "contact:\n"
      "  floor: {at: contact, against: {plane: {normal: [0, -1], position: 0}}, friction: "
      "{coulomb: 0.4}}\n"
      "  wall: {at: sides, against: {plane: {normal: [1, 0], position: 1.2 - 0.1*d}}}\n"
      "outputs:\n  up: {reaction: [0, 1], at: top}\n  aside: {reaction: [1, 0], at: top}\n"
      "  bolt: {spring: bolt}\n  foot: {mean: ux, at: contact}\n"
      "  stored: {integral: strain_energy, in: all}\n  sunk: {integral: uy, in: all}\n"
      "  moved: {integral: ux, at: top}\n  spread: {integral: ux*nx + uy*ny, at: sides}\n";
  return make_scene(read_case(text, "block.yaml"), {});
}

/// Energy from the stored energy and the work of loads, springs and free strain; reactions from
/// what contact, loads and springs push with.
void expect_sums(const Mu &mu, const Outputs &outputs, double near) {
  const double d = mu[0], area = 1.2 * 1.1 * 0.5, free_strain = 0.2 * d, bulk = mu[1] / 1.2;
  std::map<std::string, double> found = values_of(outputs);
  ASSERT_EQ(outputs.interfaces.size(), 2U);
  const Outputs &floor = outputs.interfaces[0], &wall = outputs.interfaces[1];
  EXPECT_GT(*floor.normal_force, 0.1);
  EXPECT_GT(*floor.tangential_force, 0.01);
  EXPECT_GT(*wall.normal_force, 0.01);
  EXPECT_NEAR(*wall.horizontal_reaction, -*wall.normal_force, near);
  EXPECT_NEAR(found["bolt"], 3 * found["foot"] + d, near);
  EXPECT_NEAR(found["up"] + *outputs.reaction - 2 * d * area, 0, near);
  EXPECT_NEAR(found["aside"] + *outputs.horizontal_reaction + 0.5 * 1.2 - found["bolt"], 0, near);
  const double work = -2 * d * found["sunk"] + 0.5 * found["moved"] - 0.2 * d * found["spread"],
               springs = 1.5 * found["foot"] * found["foot"] + d * found["foot"];
  EXPECT_NEAR(*outputs.energy,
              found["stored"] - 4.5 * bulk * free_strain * free_strain * area - work + springs,
              near);
}

TEST(NamedOutputs, AreSumsOfEachOtherWhereEverythingActs) {
  const Mu mu{0.047, 13};
  const Scene scene = everything_acts();
  {
    Problem problem(PETSC_COMM_WORLD, scene, {});
    expect_sums(mu, HighFidelity(problem, {}).solve(mu).outputs, 1e-10);
  }
  Reduced made(scene, "grid:3,3");
  made.reduce(testing_reduced::everything());
  if (rank_of(PETSC_COMM_WORLD) != 0) return;
  OnlineSolver online(made.model);
  expect_sums(mu, online.outputs(mu, online.solve(mu)), 1e-7);
}

/// Of a boundary that alone holds its body it is what balances contact and loads, however poor the
/// model; of one that shares nodes with contact, too.
TEST(NamedOutputs, AReactionIsInBalanceInAPoorModel) {
  const Scene scene = pressed("imposed: {top: {at: top, uy: -d*(1 + x)}, sides: {at: sides, ux: "
                              "0}}\nloads: {edge: {at: top, traction: [0.2, 0.1*x]}}\n",
                              "  up: {reaction: [0, 1], at: top}\n"
                              "  aside: {reaction: [1, 0], at: sides}\n",
                              "plane_strain");
  const Mu mu{0.047, 13};
  Reduced made(scene, "grid:3,2");
  ReduceOptions poor;
  poor.pod.tolerance = 0.05;
  made.reduce(poor);
  if (rank_of(PETSC_COMM_WORLD) != 0) return;
  OnlineSolver online(made.model);
  const Outputs outputs = online.outputs(mu, online.solve(mu));
  std::map<std::string, double> found = values_of(outputs);
  EXPECT_NEAR(found["up"] + *outputs.reaction + 0.05, 0, 1e-11);
  EXPECT_NEAR(found["aside"] + *outputs.horizontal_reaction + 0.2, 0, 1e-11);
  EXPECT_GT(*outputs.reaction, 0.1);
}

/// Where springs and weight act, too, it is of stored rows, and the translation is a function of
/// the basis.
TEST(NamedOutputs, AReactionBesideSpringsIsInBalanceInAPoorModel) {
  const Scene scene =
      pressed("imposed: {top: {at: top, uy: -d*(1 + x)}}\n"
              "loads: {weight: {at: all, force: [0, -x*d]}}\n"
              "springs: {side: {at: contact, direction: [0, 1], stiffness: 5}, hold: "
              "{at: contact, direction: [1, 0], stiffness: 8, pretension: d}}\n",
              "  up: {reaction: [0, 1], at: top}\n  side: {spring: side}\n"
              "  sunk: {integral: uy, in: all}\n",
              "plane_strain");
  const Mu mu{0.047, 13};
  Reduced made(scene, "grid:1,1");
  ReduceOptions poor;
  poor.pod.tolerance = 0.05;
  poor.condensed.responses = 0;
  made.reduce(poor);
  const Outputs full = HighFidelity(made.problem, {}).solve(mu).outputs;
  std::map<std::string, double> exact = values_of(full);
  EXPECT_NEAR(exact["up"] + *full.reaction - exact["side"], 0.25 * mu[0], 1e-10);
  if (rank_of(PETSC_COMM_WORLD) != 0) return;
  OnlineSolver online(made.model);
  const Outputs outputs = online.outputs(mu, online.solve(mu));
  std::map<std::string, double> found = values_of(outputs);
  EXPECT_GT(std::abs(found["sunk"] - exact["sunk"]), 1e-6 * std::abs(exact["sunk"])) << "is poor";
  EXPECT_NEAR(found["up"] + *outputs.reaction - found["side"], 0.25 * mu[0], 1e-10);
}

/// Of several boundaries they are of stored rows: what wrong rows leave of their balance is
/// kept and said.
TEST(NamedOutputs, ReactionsOfAModelThatAreNotInBalanceAreNamed) {
  const Scene scene = pressed("imposed: {top: {at: top, ux: 0, uy: -d*(1 + x)}}\n"
                              "loads: {weight: {at: all, force: [0, -2*d]}}\n",
                              "  up: {reaction: [0, 1], at: top}\n"
                              "  aside: {reaction: [1, 0], at: top}\n",
                              "plane_strain");
  Reduced made(scene, "grid:3,3");
  made.reduce(testing_reduced::everything());
  const auto warning = [&] {
    std::ostringstream text;
    if (rank_of(PETSC_COMM_WORLD) == 0) warn_of_balance(text, made.model);
    return text.str();
  };
  EXPECT_EQ(warning(), "");
  made.model.outputs.basis *= 1.001; // rows that are a thousandth off
  compare_balance(made.problem, made.model);
  if (rank_of(PETSC_COMM_WORLD) != 0) return;
  EXPECT_EQ(warning().find("warning: forces on a body, its reactions among them, miss"), 0U);
  EXPECT_GT(made.model.made.histories.at("self_check/balance").front(), 1e-6);
}

/// Each in a unit of its own is what it is in that of the case, over how many one is.
TEST(NamedOutputs, AreToldInTheirUnit) {
  const std::vector<std::array<std::string, 2>> kinds{
      {"integral: pressure, at: floor", "kN/mm"},
      {"reaction: [0, 1], at: top", "kN/mm"},
      {"moment: z, about: [0, 1], at: floor", "kN"},
      {"measure: pressure > 0, at: floor", "m"},
      {"max: pressure, where: x > 0.5, at: floor", "GPa"},
      {"mean: uy, in: all", "m"}};
  std::string outputs;
  for (std::size_t i = 0; i < kinds.size(); ++i)
    outputs += "  own" + std::to_string(i) + ": {" + kinds[i][0] + "}\n  told" + std::to_string(i) +
               ": {" + kinds[i][0] + ", unit: " + kinds[i][1] + "}\n";
  const Scene scene = pressed("imposed: {top: {at: top, ux: d/2, uy: -d}}\n", outputs,
                              "plane_strain\nunits: {length: mm, force: N}");
  compare_balance(scene, {0.07, 12}, [&](const std::map<std::string, double> &values) {
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      const double own = values.at("own" + std::to_string(i));
      EXPECT_GT(std::abs(own), 1e-3) << kinds[i][0];
      EXPECT_NEAR(values.at("told" + std::to_string(i)), own / 1000, 1e-12 * std::abs(own))
          << kinds[i][0];
    }
  });
  for (std::size_t i = 0; i < kinds.size(); ++i)
    EXPECT_EQ(scene.outputs[scene.outputs.size() - 2 * (kinds.size() - i) + 1].unit, kinds[i][1]);
  EXPECT_THROW(pressed("imposed: {top: {at: top, ux: 0, uy: -d}}\n",
                       "  wrong: {integral: pressure, at: floor, unit: mm}\n",
                       "plane_strain\nunits: {length: mm, force: N}"),
               Error);
}

} // namespace
} // namespace rbvi::named_outputs_test
