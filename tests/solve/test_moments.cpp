// Moments of contact: in balance with loads that contact alone carries, the integrals of pressure
// and arm, none about the centre of a sphere without friction, and what is refused.
#include "../core/refuses.hpp"
#include "../cube_mesh.hpp"
#include "../mesh/temporary_file.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/scene/case.hpp"
#include "rbvi/solve/high_fidelity.hpp"

#include <gtest/gtest.h>

#include <map>

namespace rbvi::moments_test {
namespace {

std::map<std::string, double> named(const Scene &scene, const std::string &mesh = "") {
  Problem problem(PETSC_COMM_WORLD, scene, {mesh});
  std::map<std::string, double> values;
  for (const auto &[name, value] : HighFidelity(problem, {}).solve({1}).outputs.named)
    values[name] = value;
  return values;
}

const std::string head = "rbvi: 1\n"
                         "parameters: {load: {range: [0, 2], default: 1}}\n"
                         "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n";

/// The unit square's lower half on a floor that alone holds it, with adhesion or not, under a load
/// that is neither in the middle nor straight down.
TEST(Moments, OfAPlaneBodyBalancesItsLoad) {
  for (const std::string adhesion : {"0", "0.3"}) {
    const Scene scene = make_scene(read_case(
        head +
            "physics: plane_strain\nmesh: {built_in: one_block, degree: 2}\n"
            "loads: {push: {at: top, traction: [0.05*load, -1 - 0.6*x]}}\n"
            "contact: {floor: {at: contact, adhesion: " +
            adhesion +
            ", friction: {coulomb: 0.5}, against: {plane: {normal: [0, -1], position: 0}}}}\n"
            "outputs:\n  all: {moment: z, about: [0.2*load, 0.1]}\n"
            "  rubbing: {moment: z, about: [0.2, 0.1], of: friction, at: floor}\n"
            "  pressing: {integral: pressure * (x - 0.2)}\nsmall: yes\n",
        "plane.yaml"));
    auto of = named(scene);
    EXPECT_NEAR(of["all"], 0.7 - 1.3 * 0.2 + 0.05 * (0.5 - 0.1), 1e-9);
    EXPECT_NEAR(of["rubbing"], -0.05 * 0.1, 1e-10);
    EXPECT_NEAR(of["pressing"] + of["rubbing"], of["all"], 1e-10);
  }
}

TEST(Moments, OfTheFirstOfTwoBodies) {
  const Scene scene = make_scene(read_case(
      head + "physics: plane_strain\nmesh: {built_in: two_blocks, degree: 2}\n"
             "map: [x, 'y > 0 ? y - 0.25 : y + 0.25']\n"
             "imposed:\n  top: {at: top, ux: 0, uy: -0.05*load}\n  bottom: {at: bottom, ux: 0, uy: "
             "0}\n  sides: {at: sides, ux: 0}\n"
             "contact: {blocks: {at: slave, against: master, projection: vertical}}\n"
             "outputs:\n  all: {moment: z, about: [0.2, 3]}\n"
             "  pressing: {integral: pressure * (x - 0.2)}\nsmall: yes\n",
      "two.yaml"));
  auto of = named(scene);
  EXPECT_GT(of["pressing"], 0.1);
  EXPECT_NEAR(of["all"], of["pressing"], 1e-10);
}

std::string axes(const std::string &name, const std::string &about, const std::string &rest = "") {
  std::string result;
  for (const std::string axis : {"x", "y", "z"})
    result +=
        "  " + name + " " + axis + ": {moment: " + axis + ", about: [" + about + "]" + rest + "}\n";
  return result;
}

/// A cube on a floor that alone holds it, under a load that presses beside its middle, pushes and
/// turns.
TEST(Moments, OfASolidBalancesItsLoad) {
  const TemporaryFile mesh(cube_mesh(3, 0.1));
  const Scene scene = make_scene(read_case(
      head +
          "physics: solid\nmesh: {file: cube.msh, degree: 2}\n"
          "loads: {push: {at: z1, traction: [0.05*load + 0.1*(y - 0.5), 0.03, -1 - "
          "0.5*x - 0.25*y]}}\n"
          "contact: {floor: {at: z0, friction: {coulomb: 0.5}, against: {plane: "
          "{normal: [0, 0, -1], position: 0}}}}\n"
          "outputs:\n" +
          axes("all", "0.2, 0.1*load, 0.3") + axes("rubbing", "0.2, 0.1, 0.3", ", of: friction") +
          "  pressing x: {integral: pressure * (y - 0.1)}\n"
          "  pressing y: {integral: -pressure * (x - 0.2)}\nsmall: yes\n",
      "cube.yaml"));
  auto of = named(scene, mesh.name());
  const double z = -1.375, x_z = -(0.5 + 0.5 / 3 + 0.25 / 4), y_z = -(0.5 + 0.5 / 4 + 0.25 / 3),
               y_x = 0.025 + 0.1 / 12;
  EXPECT_NEAR(of["all x"], -(y_z - 0.1 * z - 0.7 * 0.03), 1e-9);
  EXPECT_NEAR(of["all y"], -(0.7 * 0.05 - x_z + 0.2 * z), 1e-9);
  EXPECT_NEAR(of["all z"], -(0.3 * 0.03 - y_x + 0.1 * 0.05), 1e-9);
  EXPECT_NEAR(of["pressing x"] + of["rubbing x"], of["all x"], 1e-10);
  EXPECT_NEAR(of["pressing y"] + of["rubbing y"], of["all y"], 1e-10);
  EXPECT_NEAR(of["rubbing z"], of["all z"], 1e-10);
}

/// About the centre of a rigid sphere friction alone has a moment.
TEST(Moments, OfPressureVanishAboutARigidSphere) {
  const TemporaryFile mesh(cube_mesh(4, 0.1));
  for (const std::string friction : {"0", "0.4"}) {
    const Scene scene = make_scene(read_case(
        head +
            "physics: solid\nmesh: {file: cube.msh, degree: 2}\n"
            "imposed: {top: {at: z1, ux: 0.02, uy: 0.03, uz: -0.05*load}}\n"
            "contact: {foot: {at: z0, friction: {coulomb: " +
            friction + "}, against: {sphere: {center: [0.45, 0.6, -1], radius: 1}}}}\noutputs:\n" +
            axes("all", "0.45, 0.6, -1") + axes("rubbing", "0.45, 0.6, -1", ", of: friction") +
            "small: yes\n",
        "cube.yaml"));
    auto of = named(scene, mesh.name());
    for (const std::string axis : {" x", " y", " z"})
      EXPECT_NEAR(of["all" + axis], of["rubbing" + axis], 1e-12) << "a force of 0.2, a radius of 1";
    if (friction != "0")
      EXPECT_GT(std::hypot(of["all x"], of["all y"]), 1e-3);
    else
      EXPECT_LE(std::hypot(of["all x"], of["all y"], of["all z"]), 1e-12);
  }
}

TEST(Moments, RefusesWhatHasNone) {
  const std::string body = head + "mesh: {built_in: one_block, degree: 2}\n"
                                  "imposed: {top: {at: top, ux: 0, uy: -0.05*load}}\n";
  const auto contact = [](const std::string &more) {
    return "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], position: 0}}" +
           more + "}}\n";
  };
  const auto expect = [&](const std::string &says, const std::string &sections) {
    EXPECT_TRUE(refuses(says, [&] { (void)make_scene(read_case(body + sections, "c.yaml")); }));
  };
  const std::string plane = "physics: plane_strain\n",
                    all = "outputs: {turn: {moment: z, about: [0, 0]}}\n";
  expect("axisymmetric", "physics: axisymmetric\n" + contact("") + all);
  expect("small kinematics", plane + contact(", kinematics: large") + all);
  expect("by multipliers", plane + contact(", formulation: nitsche") + all);
  expect("cancels", plane + contact("") + "mirror: {x: 0}\n" + all);
  expect("about [x, y]", plane + contact("") + "outputs: {turn: {moment: z, about: [0, 0, 0]}}\n");
  expect("use one of z", plane + contact("") + "outputs: {turn: {moment: x, about: [0, 0]}}\n");
  expect("contacts, whole",
         plane + contact("") + "outputs: {turn: {moment: z, about: [0, 0], where: x > 0}}\n");
  expect("contacts, whole",
         plane + contact("") + "outputs: {turn: {moment: z, about: [0, 0], at: top}}\n");
  expect("those of a moment",
         plane + contact("") + "outputs: {turn: {integral: pressure, about: [0, 0]}}\n");
}

} // namespace
} // namespace rbvi::moments_test
