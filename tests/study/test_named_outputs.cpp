// Outputs of a case's own: against closed forms, full and reduced, and back from files.
#include "../core/refuses.hpp"
#include "../mesh/temporary_file.hpp"
#include "reduced.hpp"

#include "rbvi/io/output_table.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/model/print.hpp"
#include "rbvi/mor/reduced_balance.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/scene/case.hpp"
#include "rbvi/study/output_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <sstream>

#include <unistd.h>

namespace rbvi::named_outputs_test {
namespace {

using testing_reduced::Reduced;

/// A block with a constant pressure p on its foot, 0 <= x <= 1, that carries the shear stress t.
Scene block(const std::string &outputs) {
  const std::string text =
      "rbvi: 1\nphysics: plane_strain\nmesh: {built_in: one_block, degree: 2}\n"
      "parameters: {p: {range: [0.5, 2], default: 1}, t: {range: [0, 0.2], default: 0.1}, "
      "level: {range: [0.1, 0.9], default: 0.3}}\n"
      "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
      "loads:\n  top: {at: top, traction: [t, -p]}\n"
      "  sides: {at: sides, traction: ['-p * 0.3 / 0.7 * nx', 't * nx']}\n"
      "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], position: 0}}, "
      "friction: {coulomb: 0.5}}}\noutputs:\n" +
      outputs;
  return make_scene(read_case(text, "block.yaml"), {});
}

const std::string all_kinds = "  force: {integral: pressure, at: floor}\n"
                              "  moment: {integral: pressure * x}\n"
                              "  left: {measure: 'pressure > p/2 and x < level'}\n"
                              "  ramp: {measure: 'pressure * x > level * p'}\n"
                              "  middle: {mean: x, where: x > level}\n"
                              "  first: {min: x, where: x >= level}\n"
                              "  shear: {max: abs(tangential)}\n"
                              "  sunk: {min: uy}\n"
                              "  open: {max: gap}\n"
                              "  corner: {value: ux, point: [1, 0.5]}\n"
                              "  inside: {value: sigma_xy, point: [0.37, 0.21]}\n"
                              "  top: {mean: uy, at: top}\n"
                              "  pull: {integral: sigma_xy*nx + sigma_yy*ny, at: [top, contact]}\n"
                              "  half: {integral: x, at: top, where: x < level}\n"
                              "  stored: {integral: strain_energy, in: all}\n"
                              "  stress: {max: von_mises, in: all}\n"
                              "  deep: {min: 'uy*y', in: all}\n";

std::map<std::string, double> values_of(const Outputs &outputs) {
  std::map<std::string, double> values;
  for (const auto &[name, value] : outputs.named)
    values[name] = value;
  return values;
}

void expect_exact(const Mu &mu, const Outputs &outputs) {
  const double p = mu[0], t = mu[1], level = mu[2], near = 1e-9;
  std::map<std::string, double> found = values_of(outputs);
  const double young = 15, poisson = 0.3, away = 1 - 2 * poisson, side = poisson / (1 - poisson),
               shear = 2 * t * (1 + poisson) / young,
               strain = -p * (1 + poisson) * away / (young * (1 - poisson));
  ASSERT_EQ(found.size(), 17U);
  EXPECT_NEAR(found["corner"], shear / 2, near);
  EXPECT_NEAR(found["inside"], t, near);
  EXPECT_NEAR(found["top"], strain / 2, near);
  EXPECT_NEAR(found["pull"], 0, near);
  EXPECT_NEAR(found["half"], level * level / 2, near) << "ends inside an edge";
  EXPECT_NEAR(found["stored"], (t * shear - p * strain) / 4, near);
  const double xx = -side * p, zz = poisson * (xx - p);
  EXPECT_NEAR(found["stress"],
              std::sqrt(((xx + p) * (xx + p) + (zz + p) * (zz + p) + (xx - zz) * (xx - zz)) / 2 +
                        3 * t * t),
              near);
  EXPECT_NEAR(found["deep"], strain / 4, near) << "at the top";
  EXPECT_NEAR(found["force"], p, near);
  EXPECT_NEAR(found["moment"], p / 2, near);
  EXPECT_NEAR(found["left"], level, near) << "ends inside an edge";
  EXPECT_NEAR(found["ramp"], 1 - level, near);
  EXPECT_NEAR(found["middle"], (1 + level) / 2, near);
  EXPECT_NEAR(found["first"], level, near);
  EXPECT_NEAR(found["shear"], t, near);
  EXPECT_NEAR(found["sunk"], 0, near);
  EXPECT_NEAR(found["open"], 0, near);
}

TEST(NamedOutputs, OfAConstantPressureAreExact) {
  Problem problem(PETSC_COMM_WORLD, block(all_kinds), {});
  HighFidelity solver(problem, {});
  for (const Mu &mu : {Mu{1, 0.1, 0.3}, Mu{1.7, 0.05, 0.71}})
    expect_exact(mu, solver.solve(mu).outputs);
}

TEST(NamedOutputs, OfAModelComeBackFromItsFile) {
  Reduced made(block(all_kinds), "grid:2,2,2");
  made.reduce(testing_reduced::everything());
  if (rank_of(PETSC_COMM_WORLD) != 0) return;
  const auto path = std::filesystem::path(testing::TempDir()) /
                    ("rbvi_outputs_" + std::to_string(::getpid()) + ".h5");
  write_model(made.model, path);
  const ReducedModel model = read_model(path, catalogue(), false);
  std::filesystem::remove(path);
  std::filesystem::remove(fields_file(path));
  OnlineSolver online(model);
  for (const Mu &mu : {Mu{0.9, 0.15, 0.45}, Mu{1.9, 0.01, 0.2}})
    expect_exact(mu, online.outputs(mu, online.solve(mu)));
}

/// A measure that did not end inside an edge would jump.
TEST(NamedOutputs, AMeasureIsContinuous) {
  Problem problem(PETSC_COMM_WORLD, block("  left: {measure: pressure * x < level}\n"), {});
  HighFidelity solver(problem, {});
  for (double level = 0.2; level < 0.8; level += 0.013)
    EXPECT_NEAR(values_of(solver.solve({1, 0.1, level}).outputs)["left"], level, 1e-9);
}

/// Pressed onto the floor and sheared by what is imposed on its top, with a load that is fixed
/// there in part, or by a spring; `map` scales it.
Scene pressed(const std::string &hold, const std::string &outputs, const std::string &physics,
              const std::string &map = "",
              const std::string &friction = ", friction: {coulomb: 0.4}") {
  const std::string text =
      "rbvi: 1\nphysics: " + physics + "\nmesh: {built_in: one_block, degree: 2}\n" + map +
      "parameters: {d: {range: [0.02, 0.1], default: 0.05}, young: {range: [10, 20], default: "
      "15}}\n"
      "materials: {rubber: {at: all, E: young, nu: 0.3}}\n" +
      hold + "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], position: 0}}" +
      friction + "}}\noutputs:\n  pressed: {integral: pressure}\n" +
      (friction.empty() ? "" : "  sheared: {integral: tangential}\n") + outputs;
  return make_scene(read_case(text, "block.yaml"), {});
}

/// The same of a full answer and of a model, at a parameter that was no sample.
void compare_balance(const Scene &scene, const Mu &mu,
                     const std::function<void(std::map<std::string, double>)> &expect) {
  {
    Problem problem(PETSC_COMM_WORLD, scene, {});
    expect(values_of(HighFidelity(problem, {}).solve(mu).outputs));
  }
  Reduced made(scene, "grid:3,3");
  made.reduce(testing_reduced::everything());
  if (rank_of(PETSC_COMM_WORLD) != 0) return;
  OnlineSolver online(made.model);
  expect(values_of(online.outputs(mu, online.solve(mu))));
}

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

/// Without friction the block follows its top aside, and spreads by as much to both sides.
TEST(NamedOutputs, TheSlipIsTheWayAlongTheFloor) {
  const std::string hold = "imposed: {top: {at: top, ux: 3*d, uy: -d}}\n";
  compare_balance(
      pressed(hold, "  slip: {mean: slip, at: floor}\n", "plane_strain", "", ""), {0.05, 12},
      [](std::map<std::string, double> found) { EXPECT_NEAR(found["slip"], 0.15, 1e-9); });
}

/// Likewise on another block, whose top spreads as well.
TEST(NamedOutputs, TheSlipBetweenBodiesIsTheWayOfOneAlongTheOther) {
  const Scene scene = make_scene(
      read_case(
          "rbvi: 1\nphysics: plane_strain\nmesh: {built_in: two_blocks, degree: 2}\n"
          "parameters: {d: {range: [0.02, 0.1], default: 0.05}, press: {range: [0.01, 0.02], "
          "default: 0.015}}\n"
          "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
          "imposed: {top: {at: top, ux: d, uy: -0.5 - press}, bottom: {at: bottom, ux: 0, "
          "uy: 0}}\n"
          "contact: {faces: {at: slave, against: master, multiplier: p1}}\n"
          "outputs: {slip: {mean: slip}, gap: {max: abs(gap)}, force: {integral: pressure}}\n",
          "blocks.yaml"),
      {});
  compare_balance(scene, {0.07, 0.013}, [](std::map<std::string, double> found) {
    EXPECT_NEAR(found["slip"], 0.07, 1e-3) << "meshes that are not symmetric";
    EXPECT_LT(found["gap"], 1e-3);
    EXPECT_GT(found["force"], 0.1);
  });
}

/// Of the whole circumference: a disc of radius 1 and height 0.5 that turns about x = 0.
TEST(NamedOutputs, OfATurnedBodyAreOfTheWholeCircumference) {
  const Scene scene =
      pressed("imposed: {top: {at: top, ux: 0, uy: -d}}\n",
              "  volume: {integral: 1, in: all}\n  inner: {measure: x < 0.5, at: top}\n"
              "  side: {integral: nx, at: sides, where: x > 0.5}\n"
              "  up: {reaction: [0, 1], at: top}\n",
              "axisymmetric");
  compare_balance(scene, {0.05, 12}, [](std::map<std::string, double> found) {
    const double pi = std::acos(-1.0);
    EXPECT_NEAR(found["volume"], pi / 2, 1e-12);
    EXPECT_NEAR(found["inner"], pi / 4, 1e-9);
    EXPECT_NEAR(found["side"], pi, 1e-12);
    EXPECT_NEAR(found["up"] + found["pressed"], 0, 1e-9);
  });
}

/// Loads, materials and outputs of overlapping parts are those of the whole.
TEST(NamedOutputs, OfOverlappingPartsCountThemOnce) {
  const auto answer = [](const std::string &body, const std::string &arc) {
    const Scene scene = make_scene(
        read_case("rbvi: 1\nphysics: plane_strain\nmesh: {built_in: half_disc, degree: 1}\n"
                  "parameters: {p: {range: [0.01, 0.02], default: 0.01}}\n"
                  "materials: {rubber: {at: " +
                      body + ", E: 15, nu: 0.3}}\nimposed: {top: {at: top, ux: 0, uy: 0}}\n" +
                      "loads: {weight: {at: " + body + ", force: [0, -p]}, sides: {at: " + arc +
                      ", pressure: p}}\ncontact: {floor: {at: contact, against: {plane: {normal: "
                      "[0, -1], position: 0.99}}}}\noutputs: {length: {integral: 1, at: " +
                      arc + "}, height: {mean: y, in: " + body +
                      "}, push: {integral: pressure, "
                      "at: [floor, floor]}, depth: {min: uy, at: " +
                      arc + "}}\n",
                  "disk.yaml"),
        {});
    Problem problem(PETSC_COMM_WORLD, scene, {});
    Outputs outputs = HighFidelity(problem, {}).solve({0.015}).outputs;
    std::map<std::string, double> values = values_of(outputs);
    values["energy"] = outputs.energy.value();
    return values;
  };
  const auto whole = answer("all", "arc");
  EXPECT_NEAR(whole.at("length"), M_PI, 1e-3);
  for (const auto &[body, arc] : std::map<std::string, std::string>{
           {"[core, all]", "[contact, arc]"}, {"[all, core]", "[arc, contact, arc]"}})
    for (const auto &[name, value] : answer(body, arc))
      EXPECT_NEAR(value, whole.at(name), 1e-9 * std::abs(whole.at(name))) << name << body << arc;
}

TEST(NamedOutputs, AreRefusedWhereTheyAreNotKnown) {
  const std::string hold = "imposed: {top: {at: top, ux: 0, uy: -d}, sides: {at: sides, ux: 0}}\n";
  const auto expect_refused = [&](const std::string &output, const std::string &words) {
    try {
      const Problem problem(PETSC_COMM_WORLD, pressed(hold, output, "plane_strain"), {});
      FAIL() << output;
    } catch (const Error &error) {
      EXPECT_EQ(error.status(), Status::bad_input);
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  expect_refused("  far: {value: ux, point: [3, 0.2]}\n", "which no cell of the mesh has");
  expect_refused("  side: {reaction: [0, 1], at: sides}\n", "which is not held in its direction");
  const std::string spring =
      "imposed: {top: {at: top, ux: 0}}\nsprings: {bolt: {at: top, stiffness: "
      "3, pretension: 20*d, direction: [0.6, 0.8]}}\n";
  try {
    const Problem problem(PETSC_COMM_WORLD,
                          pressed(spring, "  aside: {reaction: [1, 0], at: top}\n", "plane_strain"),
                          {});
    FAIL() << "a spring on the boundary of a reaction";
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find("which shares nodes with 'top'"), std::string::npos)
        << error.what();
  }
  Scene misspelt = pressed(hold, "", "plane_strain"); // as a program may make it
  misspelt.outputs.front().at = {"flor"};
  EXPECT_THROW(Problem(PETSC_COMM_WORLD, misspelt, {}), Error);
}

/// An empty cell, and no failure; errors are over the answers that have a value.
TEST(NamedOutputs, OverNothingHaveNoValue) {
  Problem problem(PETSC_COMM_WORLD, block("  none: {mean: pressure, where: x > 0.2 + level}\n"),
                  {});
  HighFidelity solver(problem, {});
  const Outputs some = solver.solve({1, 0.1, 0.3}).outputs,
                none = solver.solve({1, 0.1, 0.9}).outputs;
  EXPECT_NEAR(values_of(some)["none"], 1, 1e-9);
  EXPECT_TRUE(std::isnan(values_of(none)["none"]));
  const ParameterSpace &space = problem.scene().parameters;
  std::ostringstream table, text;
  write_csv(table, space, {{1, 0.1, 0.9}, {1, 0.1, 0.3}}, {none, some});
  EXPECT_NE(table.str().find(",none\n1,0.1,0.9,"), std::string::npos) << table.str();
  EXPECT_NE(table.str().find(",\n1,0.1,0.3,"), std::string::npos) << "an empty last cell";
  print_outputs(text, none);
  EXPECT_NE(text.str().find("(no value)"), std::string::npos) << text.str();
  for (const OutputError &error : output_errors({none, some, some}, {none, none, some}))
    EXPECT_TRUE(error.name != "none" || error.max == 0);
  for (const OutputError &error : output_errors({none}, {none}))
    EXPECT_NE(error.name, "none");
}

/// The ends of the foot are held at its sides; between them uniaxial strain.
TEST(NamedOutputs, AreOverTheWholeBoundaryBesideHeldNodes) {
  const std::string hold = "imposed: {sides: {at: sides, ux: 0, uy: -2*d*y}, "
                           "top: {at: top, uy: -d}}\n";
  const std::string outputs = "  length: {integral: 1}\n  touching: {measure: contact}\n"
                              "  closed: {measure: pressure > 0}\n  open: {max: abs(gap)}\n";
  compare_balance(pressed(hold, outputs, "plane_strain", "", ""), {0.05, 10},
                  [](std::map<std::string, double> found) {
                    EXPECT_NEAR(found["length"], 1, 1e-12);
                    EXPECT_NEAR(found["touching"], 1, 1e-12);
                    EXPECT_NEAR(found["closed"], 1, 1e-12);
                    EXPECT_NEAR(found["pressed"], 10 * 0.7 / (1.3 * 0.4) * 0.1, 1e-9);
                    EXPECT_NEAR(found["open"], 0, 1e-12);
                  });
}

/// One integral, whose sign changes inside an edge.
TEST(NamedOutputs, OfTheTangentialStressAreTheTangentialForce) {
  const std::string hold = "imposed: {top: {at: top, ux: 0.003, uy: -d}}\n";
  const Scene scene = pressed(hold, "  own: {integral: abs(tangential)}\n", "plane_strain");
  for (const bool turned : {false, true}) {
    Scene one = scene;
    if (turned)
      one = pressed("imposed: {top: {at: top, ux: 0, uy: -d}}\n",
                    "  own: {integral: abs(tangential)}\n", "axisymmetric");
    Problem problem(PETSC_COMM_WORLD, one, {});
    const Outputs outputs = HighFidelity(problem, {}).solve({0.05, 15}).outputs;
    EXPECT_GT(outputs.tangential_force.value(), 0.01);
    EXPECT_NEAR(values_of(outputs).at("own"), outputs.tangential_force.value(),
                1e-12 * outputs.tangential_force.value());
  }
}

/// Of a block on another one that faces it in part.
TEST(NamedOutputs, OfAContactThatFacesNothing) {
  const auto scene = [](const std::string &shift) {
    return make_scene(
        read_case(
            "rbvi: 1\nphysics: plane_strain\nmesh: {built_in: two_blocks, degree: 2}\n"
            "parameters: {press: {range: [0.01, 0.02], default: 0.015}}\nmap: ['y > 0 ? x + " +
                shift +
                " : x', y]\n"
                "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
                "imposed: {top: {at: top, ux: 0, uy: -0.5 - press}, bottom: {at: bottom, "
                "ux: 0, uy: 0}}\n"
                "contact: {faces: {at: slave, against: master, multiplier: p1}}\n"
                "outputs: {length: {integral: 1}, force: {integral: pressure}, gap: {max: "
                "abs(gap)}, facing: {measure: gap < 1}, touching: {measure: contact}}\n",
            "blocks.yaml"),
        {});
  };
  for (const double shift : {0.0, 0.33, 0.97}) {
    SCOPED_TRACE(shift);
    Problem problem(PETSC_COMM_WORLD, scene(std::to_string(shift)), {});
    const Outputs outputs = HighFidelity(problem, {}).solve({0.015}).outputs;
    std::map<std::string, double> found = values_of(outputs);
    EXPECT_NEAR(found["length"], 1, 1e-12);
    EXPECT_NEAR(found["facing"], 1 - shift, 1e-9);
    EXPECT_LE(found["touching"], 1 - shift + 1e-9);
    EXPECT_NEAR(found["force"], outputs.normal_force.value(), 1e-9 * outputs.normal_force.value());
  }
}

/// A body whose imposed sides go through the floor.
TEST(NamedOutputs, HeldNodesBelowTheSurfaceCountAsPenetration) {
  const Scene scene = pressed("imposed: {sides: {at: sides, ux: 0, uy: -d}}\n",
                              "  lowest: {min: uy, at: sides}\n", "plane_strain", "", "");
  const auto expect = [](const Outputs &outputs) {
    EXPECT_NEAR(outputs.max_penetration.value(), 0.05, 1e-12);
    EXPECT_EQ(outputs.held_nodes.value(), 2);
    std::ostringstream text;
    ResolutionTally tally;
    tally.add(outputs);
    tally.print(text);
    EXPECT_NE(text.str().find("imposed values hold 2 nodes of the contact boundary up to 0.05 "
                              "below the surface"),
              std::string::npos)
        << text.str();
  };
  {
    Problem problem(PETSC_COMM_WORLD, scene, {});
    expect(HighFidelity(problem, {}).solve({0.05, 15}).outputs);
  }
  Reduced made(scene, "grid:2,2");
  made.reduce(testing_reduced::everything());
  if (rank_of(PETSC_COMM_WORLD) != 0) return;
  OnlineSolver online(made.model);
  expect(online.outputs({0.05, 15}, online.solve({0.05, 15})));
}

} // namespace
} // namespace rbvi::named_outputs_test
