// Adhesion, a constant pull: blocks whose answers are known, the same as a load, and full against
// reduced.
#include "reduced.hpp"

#include "rbvi/model/online.hpp"
#include "rbvi/scene/case.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::adhesion_test {
namespace {

using testing_reduced::Reduced;

Scene scene_of(const std::string &text) {
  return make_scene(read_case("rbvi: 1\n" + text, "case.yaml"), {});
}

/// A block, 1 wide and 0.5 high, of lambda + 2 mu = 10, that is lifted off a floor: a spring of
/// stiffness 20. `more`: of the contact.
std::string lifted(const std::string &degree, const std::string &more) {
  return "physics: plane_strain\nmesh: {built_in: one_block, degree: " + degree +
         "}\nparameters: {lift: {range: [-0.1, 0.1], default: 0.02}, grip: {range: [0.5, 2], "
         "default: 1}}\nmaterials: {rubber: {at: all, lambda: 4, mu: 3}}\n"
         "imposed: {top: {at: top, uy: lift}, guides: {at: sides, ux: 0}}\n"
         "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], position: 0}}, " +
         more + "}}\noutputs: {hold: {reaction: [0, 1], at: top}, least: {min: pressure}, " +
         "closed: {measure: contact}, corner: {value: uy, point: [0, 0]}}\n";
}

double named(const Outputs &outputs, const std::string &name) {
  return std::ranges::find(outputs.named, name, &NamedOutput::name)->value;
}

/// What the spring, and nothing else, says.
void expect_lifted(const Mu &mu, const Outputs &outputs, double tolerance) {
  const double lift = mu[0], grip = mu[1], pressure = std::max(-20 * lift, -grip),
               gap = lift + pressure / 20;
  EXPECT_NEAR(*outputs.normal_force, pressure, tolerance);
  EXPECT_NEAR(*outputs.reaction, pressure, tolerance);
  EXPECT_NEAR(*outputs.peak_pressure, pressure, tolerance);
  EXPECT_NEAR(named(outputs, "least"), pressure, tolerance);
  EXPECT_NEAR(named(outputs, "hold"), -pressure, tolerance);
  EXPECT_NEAR(named(outputs, "corner"), gap, tolerance);
  EXPECT_NEAR(*outputs.energy, pressure * pressure / 40 + grip * gap, tolerance);
  if (std::abs(20 * lift - grip) < 1e-6) return; // open and closed at once
  EXPECT_EQ(*outputs.contact_nodes, gap > 1e-9 ? 0 : 9);
  EXPECT_NEAR(named(outputs, "closed"), gap > 1e-9 ? 0 : 1, tolerance);
}

/// Pressed, at rest, pulled by less, by just as much and by more than adhesion holds.
const Mu lifts[] = {{-0.04, 1}, {0, 1}, {0.03, 1}, {0.03, 0.6}, {0.06, 1}, {0.05, 0.5}};

TEST(Adhesion, HoldsABlockUpToItsPull) {
  for (const std::string degree : {"1", "2"})
    for (const std::string friction :
         {"", ", friction: {coulomb: 0.4}", ", friction: {tresca: 0.1}"}) {
      Problem problem(PETSC_COMM_WORLD, scene_of(lifted(degree, "adhesion: grip" + friction)), {});
      HfOptions options;
      options.contact = HfContact::eliminated;
      HighFidelity by_columns(problem, {}), eliminated(problem, options);
      for (const Mu &mu : lifts) {
        SCOPED_TRACE(degree + friction + " " + describe(problem.scene().parameters, mu));
        expect_lifted(mu, by_columns.solve(mu).outputs, 1e-11);
        expect_lifted(mu, eliminated.solve(mu).outputs, 1e-10);
      }
    }
}

TEST(Adhesion, IsInAModel) {
  for (const std::string friction : {"", ", friction: {coulomb: 0.4}"}) {
    Reduced block(scene_of(lifted("2", "adhesion: grip" + friction)), "grid:7,3");
    block.reduce(testing_reduced::everything());
    OnlineSolver online(block.model);
    for (const Mu &mu : lifts) {
      SCOPED_TRACE(friction + describe(block.problem.scene().parameters, mu));
      expect_lifted(mu, online.outputs(mu, online.solve(mu)), 1e-9);
    }
  }
}

/// Coulomb's bound follows the pressure, not what is above the pull: a block that is held down by
/// adhesion alone slides as freely as on ice, one that is pressed everywhere with the coefficient
/// times its force.
TEST(Adhesion, HasNoFrictionOfItsOwn) {
  Problem problem(PETSC_COMM_WORLD,
                  scene_of("physics: plane_strain\nmesh: {built_in: one_block, degree: 2}\n"
                           "parameters: {lift: {range: [-0.1, 0.1], default: 0.02}}\n"
                           "materials: {rubber: {at: all, lambda: 4, mu: 3}}\n"
                           "imposed: {top: {at: top, ux: 0.3, uy: lift}}\n"
                           "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], "
                           "position: 0}}, adhesion: 1, friction: {coulomb: 0.1}}}\n"),
                  {});
  HighFidelity solver(problem, {});
  const Outputs held = solver.solve({0.02}).outputs;
  EXPECT_LT(*held.normal_force, -0.2);
  EXPECT_EQ(*held.contact_nodes, 9);
  EXPECT_EQ(*held.stick_nodes, 0);
  EXPECT_NEAR(*held.tangential_force, 0, 1e-13);
  const Outputs pressed = solver.solve({-0.04}).outputs;
  EXPECT_GT(*pressed.normal_force, 0.5);
  EXPECT_EQ(*pressed.stick_nodes, 0);
  EXPECT_NEAR(*pressed.tangential_force, 0.1 * *pressed.normal_force, 1e-11);
  HfOptions by_steps;
  by_steps.method = HfMethod::uzawa;
  by_steps.uzawa = {.tolerance = 1e-12, .accelerated = true};
  EXPECT_NEAR(*HighFidelity(problem, by_steps).solve({-0.04}).outputs.normal_force,
              *pressed.normal_force, 1e-7);
}

/// A block that is pulled at one end and sheared: some of it is open, some adheres, some is
/// pressed.
const std::string rocking =
    "physics: plane_strain\nmesh: {built_in: one_block, degree: 2}\nMAP"
    "parameters: {pull: {range: [0.5, 3], default: 2}, grip: {range: [0.3, 1], default: 0.5}}\n"
    "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
    "imposed: {top: {at: top, ux: 0.05, uy: 0.04*(2*x - 1)*pull}}\n"
    "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], position: 0}}ADHESION}}\n"
    "outputs: {up: {reaction: [0, 1], at: top}, aside: {reaction: [1, 0], at: top}}\n";

std::string with(std::string text, const std::string &key, const std::string &value) {
  return text.replace(text.find(key), key.size(), value);
}

/// Forces balance, or solve would throw; a model answers as the full body does.
TEST(Adhesion, OfABlockThatRocksFullAndReducedAgree) {
  for (const std::string friction : {"", ", friction: {coulomb: 0.3}"})
    for (const std::string map : {"", "map: [1.2*x, 1.1*y]\n"}) {
      SCOPED_TRACE(friction + map);
      Reduced block(
          scene_of(with(with(rocking, "ADHESION", ", adhesion: grip" + friction), "MAP", map)),
          "grid:9,5 + random:40:3");
      block.reduce(testing_reduced::everything());
      HighFidelity solver(block.problem, {});
      OnlineSolver online(block.model);
      for (const Mu &mu : {Mu{1.3, 0.42}, Mu{2.9, 0.9}}) {
        const Outputs full = solver.solve(mu).outputs, found = online.outputs(mu, online.solve(mu));
        const double nodes = *full.contact_nodes;
        EXPECT_TRUE(nodes > 1 && nodes < 9) << nodes;
        EXPECT_NEAR(*found.normal_force, *full.normal_force, 1e-9);
        EXPECT_NEAR(*found.peak_pressure, *full.peak_pressure, 1e-8);
        EXPECT_NEAR(*found.energy, *full.energy, 1e-9);
        EXPECT_EQ(*found.contact_nodes, nodes);
        for (const char *name : {"up", "aside"})
          EXPECT_NEAR(named(found, name), named(full, name), 1e-8);
      }
    }
}

/// The same as a traction on the boundary, but for what outputs count as contact.
TEST(Adhesion, IsALoadThatOutputsHaveAmongTheForcesOfContact) {
  const std::string load = "loads: {pull: {at: contact, traction: [0, -grip]}}\n";
  Problem adhesive(PETSC_COMM_WORLD,
                   scene_of(with(with(rocking, "ADHESION", ", adhesion: grip"), "MAP", "")), {}),
      loaded(PETSC_COMM_WORLD, scene_of(load + with(with(rocking, "ADHESION", ""), "MAP", "")), {});
  const Mu mu{2, 0.5};
  const HfSolution one = HighFidelity(adhesive, {}).solve(mu),
                   other = HighFidelity(loaded, {}).solve(mu);
  EXPECT_LT((one.u - other.u).norm(), 1e-12 * other.u.norm());
  EXPECT_LT((one.lambda - other.lambda).norm(), 1e-11 * other.lambda.norm());
  EXPECT_NEAR(*one.outputs.energy, *other.outputs.energy, 1e-12);
  EXPECT_NEAR(*one.outputs.normal_force, *other.outputs.normal_force - mu[1], 1e-11);
  EXPECT_NEAR(*one.outputs.peak_pressure, *other.outputs.peak_pressure - mu[1], 1e-11);
  EXPECT_EQ(*one.outputs.contact_nodes, *other.outputs.contact_nodes);
}

/// Against a disk, whose normals are those of the pull: reactions balance it, or solve would throw.
TEST(Adhesion, PullsAlongTheNormalsOfARoundSurface) {
  for (const std::string normal : {"rigid", "body"}) {
    Problem problem(
        PETSC_COMM_WORLD,
        scene_of(
            "physics: plane_strain\nmesh: {built_in: annulus, edges: 16, degree: 2}\n"
            "parameters: {lift: {range: [-0.02, 0.05], default: 0}}\n"
            "curves: {bottom: {circle: [0, 0, 1]}}\n"
            "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
            "imposed: {hub: {at: hub, ux: 0.01, uy: lift}}\n"
            "contact: {peg: {at: bottom, against: {disk: {center: [0, -2], radius: 1}}, "
            "normal: " +
            normal +
            ", adhesion: 0.2}}\n"
            "outputs: {up: {reaction: [0, 1], at: hub}, aside: {reaction: [1, 0], at: hub}}\n"),
        {});
    HighFidelity solver(problem, {});
    for (const double lift : {-0.02, 0.02}) {
      const Outputs outputs = solver.solve({lift}).outputs;
      EXPECT_NEAR(named(outputs, "up") + *outputs.reaction, 0, 1e-10);
      EXPECT_NEAR(named(outputs, "aside") + *outputs.horizontal_reaction, 0, 1e-10);
      EXPECT_EQ(*outputs.contact_nodes == 0, lift > 0);
    }
  }
}

/// A membrane that hangs above a table is pulled down onto it, and there held by less than its
/// pull.
TEST(Adhesion, OfAMembraneIsALoadOnItsRegion) {
  const auto membrane = [](const std::string &adhesion, const std::string &load,
                           const std::string &lumped) {
    return scene_of("physics: membrane\nmesh: {built_in: square_with_disc, edges: 24, degree: 1}\n"
                    "parameters: {height: {range: [0.01, 0.5], default: 0.1}}\n"
                    "imposed: {frame: {at: boundary, u: height}}\n" +
                    load + "contact: {table: {at: obstacle, above: 0, lumped: " + lumped +
                    adhesion + "}}\n");
  };
  for (const std::string lumped : {"yes", "no"}) {
    Problem adhesive(PETSC_COMM_WORLD, membrane(", adhesion: 5", "", lumped), {}),
        loaded(PETSC_COMM_WORLD, membrane("", "loads: {pull: {at: obstacle, force: -5}}\n", lumped),
               {});
    for (const double height : {0.01, 0.5}) {
      const HfSolution one = HighFidelity(adhesive, {}).solve({height}),
                       other = HighFidelity(loaded, {}).solve({height});
      EXPECT_LT((one.u - other.u).norm(), 1e-12 * other.u.norm());
      const double area = 24 * 0.2 * 0.2 / 2 * std::sin(2 * std::numbers::pi / 24);
      EXPECT_NEAR(*one.outputs.normal_force, *other.outputs.normal_force - 5 * area, 1e-3);
      EXPECT_EQ(*one.outputs.contact_nodes > 0, height < 0.1);
      EXPECT_LT(*one.outputs.normal_force, 0);
    }
  }
}

} // namespace
} // namespace rbvi::adhesion_test
