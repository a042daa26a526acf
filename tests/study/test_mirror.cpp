// Half a body beyond a plane of symmetry, against the whole of it: every output is of the whole.
#include "../mesh/temporary_file.hpp"
#include "reduced.hpp"

#include "rbvi/fem/check_scene.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/scene/case.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

namespace rbvi::mirror_test {
namespace {

using testing_reduced::Reduced;

constexpr int across = 5, up = 4; ///< squares of a half

/// A block, |x| <= 0.5 or x >= 0 of it, with a round foot. Its triangles are mirrored about x = 0.
std::string block(bool half) {
  const int first = half ? 0 : -across;
  const auto node = [&](int i, int j) { return j * (across - first + 1) + i - first + 1; };
  std::ostringstream out, elements;
  out.precision(17);
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n6\n1 1 \"axis\"\n1 2 \"foot\"\n"
         "1 3 \"wall\"\n1 4 \"lug\"\n1 5 \"top\"\n2 6 \"body\"\n$EndPhysicalNames\n$Nodes\n"
      << node(across, up) << '\n';
  for (int j = 0; j <= up; ++j)
    for (int i = first; i <= across; ++i) {
      const double x = 0.5 * i / across, s = double(j) / up;
      out << node(i, j) << ' ' << x << ' ' << s + 0.2 * (1 - s) * x * x << " 0\n";
    }
  int count = 0;
  const auto add = [&](int type, int group, const std::vector<int> &nodes) {
    elements << ++count << ' ' << type << " 2 " << group << ' ' << group;
    for (const int one : nodes)
      elements << ' ' << one;
    elements << '\n';
  };
  for (int i = first; i < across; ++i) {
    add(1, 2, {node(i, 0), node(i + 1, 0)});
    add(1, 5, {node(i, up), node(i + 1, up)});
  }
  for (int j = 0; j < up; ++j) {
    if (half) add(1, 1, {node(0, j), node(0, j + 1)});
    for (const int i : half ? std::vector{across} : std::vector{first, across})
      if (j < up - 1) add(1, 2 * j < up ? 3 : 4, {node(i, j), node(i, j + 1)});
    for (int i = first; i < across; ++i) {
      const int a = node(i, j), b = node(i + 1, j), c = node(i + 1, j + 1), d = node(i, j + 1);
      add(2, 6, i < 0 ? std::vector{a, b, d} : std::vector{a, b, c});
      add(2, 6, i < 0 ? std::vector{b, c, d} : std::vector{a, c, d});
    }
  }
  out << "$EndNodes\n$Elements\n" << count << '\n' << elements.str() << "$EndElements\n";
  return out.str();
}

/// What is beside the body and the plane of symmetry.
struct Around {
  std::string formulation, friction;
  bool walls = false; ///< a second contact, beside the body
  bool tied = false;  ///< the top is pressed by a force
};

const std::string of_own =
    "  pull: {spring: pull}\n  moment: {integral: pressure * x, at: foot}\n"
    "  pressed: {integral: pressure}\n  tight: {measure: pressure > 1, at: foot}\n"
    "  aside: {integral: ux, in: all}\n  far: {max: ux, in: all}\n  near: {min: ux, at: lug}\n"
    "  stored: {integral: strain_energy, in: all}\n  deep: {mean: uy, at: lug}\n"
    "  right: {integral: uy, in: all, where: x > 0.1}\n  edge: {value: ux, point: [0.5, 0.75]}\n"
    "  through: {integral: sigma_xy * nx + sigma_yy * ny, at: lug}\n";

Scene scene_of(const std::string &mesh, bool half, const Around &around) {
  const std::string how = ", formulation: " + around.formulation + around.friction;
  const std::string text =
      "rbvi: 1\nphysics: plane_strain\nmesh: {file: " + mesh + ", degree: 2}\n" +
      "parameters: {load: {range: [0.8, 1.2], default: 1}}\n"
      "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
      "loads: {weight: {at: all, force: [0, -0.3 * load]}}\n"
      "springs: {pull: {at: lug, stiffness: 4, pretension: 0.2 * load, settled: -0.01}}\n"
      "imposed:\n  top: {at: top, ux: 0, " +
      (around.tied ? "force_y: -0.7 * load" : "uy: -0.05 * load") + "}\n" +
      (half ? "  axis: {at: axis, ux: 0}\nmirror: {x: 0}\n" : "") +
      "contact:\n  foot: {at: foot, against: {plane: {normal: [0, -1], position: 0}}" + how +
      "}\n" +
      (around.walls ? "  walls: {at: wall, against: {level_set: '0.503 - abs(x)'}" + how + "}\n"
                    : "") +
      "outputs:\n" + of_own + (around.tied ? "" : "  hold: {reaction: [0, 1], at: top}\n") +
      (around.friction.empty() ? ""
                               : "  shear: {integral: tangential, at: foot}\n"
                                 "  rubs: {integral: abs(tangential), at: foot}\n");
  return make_scene(read_case(text, "half.yaml"), {});
}

/// Each output of one is one of the other, but for those of the solver.
void compare(const Outputs &half, const Outputs &whole, double tolerance) {
  const auto is_of_solver = [](const std::string &name) {
    return name.ends_with("residual") || name == "iterations" || name == "seconds" ||
           name.starts_with("expected") || name == "contraction" || name == "load_steps";
  };
  for (const OutputColumn &column : columns_of({half, whole})) {
    if (is_of_solver(column.name)) continue;
    const std::optional<double> a = column.of(half), b = column.of(whole);
    if (column.name == "horizontal_reaction") {
      EXPECT_FALSE(a) << "it cancels";
      EXPECT_NEAR(b.value_or(0), 0, 1e-9);
      continue;
    }
    ASSERT_TRUE(a && b) << column.name;
    EXPECT_NEAR(*a, *b, tolerance * std::max(1.0, std::abs(*b))) << column.name;
  }
  EXPECT_NEAR(half.free_nodes.value_or(0), whole.free_nodes.value_or(0), 1e-9);
  EXPECT_EQ(half.slip_directions, whole.slip_directions);
}

/// Full and reduced, at a parameter that is no sample.
void expect_of_whole(const Around &around, double tolerance) {
  const Mu mu{1.07};
  Outputs expected;
  {
    const TemporaryFile file(block(false));
    Problem whole(PETSC_COMM_WORLD, scene_of(file.name(), false, around), {file.name(), 0});
    expected = HighFidelity(whole, {}).solve(mu).outputs;
  }
  EXPECT_GT(*expected.contact_nodes, 3);
  const TemporaryFile file(block(true));
  Reduced half(scene_of(file.name(), true, around), "grid:5", PETSC_COMM_WORLD, {file.name(), 0});
  compare(HighFidelity(half.problem, {}).solve(mu).outputs, expected, 1e-9);
  half.reduce(testing_reduced::everything());
  if (rank_of(PETSC_COMM_WORLD) != 0) return;
  OnlineSolver online(half.model);
  compare(online.outputs(mu, online.solve(mu)), expected, tolerance);
}

TEST(Mirror, OutputsAreOfTheWholeBody) {
  expect_of_whole({"mixed", ""}, 1e-7);
}

TEST(Mirror, OutputsAreOfTheWholeBodyWithFrictionAndATotalForce) {
  expect_of_whole({"mixed", ", friction: {coulomb: 0.05}", false, true}, 1e-7);
}

TEST(Mirror, OutputsOfTwoContactsAreOfTheWholeBody) {
  expect_of_whole({"mixed", ", friction: {coulomb: 0.05}", true, false}, 1e-7);
}

TEST(Mirror, OutputsAreOfTheWholeBodyByNitschesMethod) {
  expect_of_whole({"nitsche", "", false, true}, 1e-4);
}

/// It is its own image.
TEST(Mirror, ThePlaneItselfCountsOnce) {
  const TemporaryFile file(block(true));
  const std::string text =
      "rbvi: 1\nphysics: plane_strain\nmesh: {file: " + file.name() + ", degree: 1}\n" +
      "parameters: {d: {range: [0.01, 0.1], default: 0.05}}\n"
      "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
      "imposed:\n  top: {at: top, uy: -d}\n  axis: {at: axis, ux: 0}\nmirror: {x: 0}\n"
      "contact: {foot: {at: foot, against: {plane: {normal: [0, -1], position: 0}}}}\n"
      "outputs: {along: {integral: y, at: axis}, across: {measure: y > 0.9, at: [axis, top]}}\n";
  Problem problem(PETSC_COMM_WORLD, make_scene(read_case(text, "half.yaml"), {}), {file.name(), 0});
  const std::vector<NamedOutput> found = HighFidelity(problem, {}).solve({0.05}).outputs.named;
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[0].value, 0.5, 1e-12);
  EXPECT_NEAR(found[1].value, 1.1, 1e-9);
}

/// What crosses the plane is none of the whole body; a plane that is none of the mesh is refused.
TEST(Mirror, WhatDoesNotFitThePlaneIsRefused) {
  const TemporaryFile file(block(true));
  const auto refused = [&](const std::string &lines, const std::string &says) {
    const std::string text =
        "rbvi: 1\nphysics: plane_strain\nmesh: {file: " + file.name() + "}\n" +
        "parameters: {d: {range: [0.01, 0.1], default: 0.05}}\n"
        "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
        "contact: {foot: {at: foot, against: {plane: {normal: [0, -1], position: 0}}}}\n" +
        lines;
    try {
      const Problem problem(PETSC_COMM_WORLD, make_scene(read_case(text, "half.yaml"), {}),
                            {file.name(), 0});
      check_scene(problem);
    } catch (const Error &error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
      return;
    }
    ADD_FAILURE() << "accepted: " << says;
  };
  const std::string held = "imposed:\n  top: {at: top, uy: -d}\n  axis: {at: axis, ux: 0}\n";
  refused(held + "mirror: {x: 1}\n", "does not end at the plane of symmetry x = 1");
  refused("imposed: {top: {at: top, ux: 0, uy: -d}}\nmirror_images: 2\n", "can leave it");
  refused(held + "mirror_images: 3\n", "mirror_images is 3");
  refused(held + "mirror: {x: 0}\nmirror_images: 2\n", "say the same");
  refused(held + "mirror: {x: 0}\nsprings: {s: {at: lug, stiffness: 1, direction: [1, 0]}}\n",
          "cancels");
  refused(held + "mirror: {x: 0}\noutputs: {o: {reaction: [1, 0], at: axis}}\n", "cancels");
  refused("imposed:\n  top: {at: top, uy: -d}\n  axis: {at: axis, ux: 0}\n"
          "  lug: {at: lug, force_x: 1}\nmirror: {x: 0}\n",
          "cancels");
}

} // namespace
} // namespace rbvi::mirror_test
