// Outputs of a case's own: against closed forms, full and reduced, and back from files.
#include "named_outputs.hpp"

#include "rbvi/core/warnings.hpp"
#include "rbvi/io/output_table.hpp"
#include "rbvi/model/print.hpp"
#include "rbvi/study/output_errors.hpp"

#include <cmath>
#include <filesystem>
#include <sstream>

#include <unistd.h>

namespace rbvi::named_outputs_test {
namespace {

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

TEST(NamedOutputs, OneAloneIsTheSame) {
  Reduced made(block(all_kinds), "grid:2,2,2");
  made.reduce(testing_reduced::everything());
  if (rank_of(PETSC_COMM_WORLD) != 0) return;
  const Mu mu{0.9, 0.15, 0.45};
  OnlineSolver all(made.model);
  const std::map<std::string, double> known = values_of(all.outputs(mu, all.solve(mu)));
  for (const auto &[name, value] : known) {
    OnlineSolver one(made.model, {.only = {name}});
    const Outputs outputs = one.outputs(mu, one.solve(mu));
    ASSERT_EQ(outputs.named.size(), 1U) << name;
    EXPECT_EQ(values_of(outputs).at(name), value) << name;
  }
}

/// Both are sums by Gauss points of the same functions.
void expect_alike(const std::string &physics, const std::string &outputs,
                  const std::vector<std::array<std::string, 2>> &pairs, double near = 1e-12) {
  const Scene scene = make_scene(read_case("rbvi: 1\nphysics: " + physics + outputs, "own.yaml"));
  Problem problem(PETSC_COMM_WORLD, scene, {});
  std::map<std::string, double> found = values_of(HighFidelity(problem, {}).solve({0.05}).outputs);
  for (const auto &[one, other] : pairs) {
    EXPECT_NE(found.at(one), 0);
    EXPECT_NEAR(found.at(one), found.at(other), near * std::abs(found.at(other))) << one << outputs;
  }
}

/// Eight edges of a round body on a plane, of which gap and slip are parts of the displacement.
TEST(NamedOutputs, OverContactAreThoseOverItsBoundary) {
  for (const std::string keys :
       {"gap_from: edges", "gap_from: edges, kinematics: large", "gap_from: edges, lumped: yes",
        "gap_from: edges, formulation: nitsche"})
    for (const std::string degree : {"1", "2"})
      expect_alike(
          "plane_strain\n",
          "mesh: {built_in: half_disc, angle: 45, edges: 8, degree: " + degree +
              "}\nparameters: {push: {range: [0, 0.1], default: 0.05}}\n"
              "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
              "imposed: {top: {at: top, ux: 0.2*push, uy: -push}}\n"
              "contact: {foot: {at: contact, friction: {coulomb: 0.3}, against: {plane: "
              "{normal: [0, -1], position: 1.001}}, " +
              keys +
              "}}\noutputs:\n"
              "  down:  {integral: uy * x + ux^2, at: foot}\n"
              "  down_of_boundary:  {integral: uy * x + ux^2, at: contact}\n"
              "  gap:  {integral: gap, at: foot}\n"
              "  gap_of_boundary:  {integral: 1.001 + y + uy, at: contact}\n"
              "  slip:  {mean: slip, at: foot, where: gap < 0.05}\n"
              "  slip_of_boundary:  {mean: ux, at: contact, where: 1.001 + y + uy < 0.05}\n",
          {{"down", "down_of_boundary"}, {"gap", "gap_of_boundary"}, {"slip", "slip_of_boundary"}},
          1e-9);
}

/// Two blocks whose meshes do not match: kinks of one inside edges of the other are fitted.
TEST(NamedOutputs, OverTwoBodiesAreThoseOverTheirBoundaries) {
  const std::string text =
      "mesh: {built_in: two_blocks, degree: 2}\n"
      "parameters: {push: {range: [0, 0.1], default: 0.05}}\n"
      "map: [x, 'y > 0 ? y - 0.25 : y + 0.25']\n"
      "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
      "imposed:\n  top: {at: top, ux: 0, uy: -push * (1 + x^2)}\n  bottom: {at: bottom, ux: 0, uy: "
      "0}\n"
      "contact: {between: {at: slave, against: master}}\noutputs:\n"
      "  down: {integral: uy * x, at: between}\n  down_of_slave: {integral: uy * x, at: slave}\n";
  expect_alike("plane_strain\n", text, {{"down", "down_of_slave"}});
}

/// A measure that did not end inside an edge would jump.
TEST(NamedOutputs, AMeasureIsContinuous) {
  Problem problem(PETSC_COMM_WORLD, block("  left: {measure: pressure * x < level}\n"), {});
  HighFidelity solver(problem, {});
  for (double level = 0.2; level < 0.8; level += 0.013)
    EXPECT_NEAR(values_of(solver.solve({1, 0.1, level}).outputs)["left"], level, 1e-9);
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
