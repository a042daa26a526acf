// Parts of bodies in space that planes of symmetry cut out, with friction: the answers of the whole
// on the mesh with its images.
#include "../core/refuses.hpp"
#include "../cube_mesh.hpp"
#include "../mesh/temporary_file.hpp"
#include "rbvi/fem/check_scene.hpp"
#include "rbvi/scene/case.hpp"
#include "rbvi/solve/high_fidelity.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace rbvi::solid_halves_test {
namespace {

struct Answer {
  Outputs outputs;
  std::vector<Point> points; ///< dual nodes
  Matrix tractions;          ///< of each: the pressure, then the tangential traction
};

Answer answer(std::array<bool, 3> images, const std::string &sections) {
  const TemporaryFile mesh(cube_mesh(4, 0.1, images));
  const Scene scene = make_scene(
      read_case("rbvi: 1\nphysics: solid\nmesh: {file: cube.msh, degree: 2}\n" + sections, "c"));
  Problem problem(PETSC_COMM_WORLD, scene, {mesh.name()});
  check_scene(problem);
  const HfSolution solution = HighFidelity(problem, {}).solve({0.05});
  ContactInterface &contact = *problem.contact().interfaces.front();
  const Grid grid = contact.fields(scene.parameters.all.empty() ? FullMu{} : FullMu{0.05},
                                   Vector::Zero(3 * contact.mesh().nodes()), solution.lambda, true);
  const auto field = [&](const std::string &name, Index components) {
    return Matrix(std::ranges::find(grid.of_nodes, name, &Field::name)
                      ->values.reshaped(components, grid.points.rows()));
  };
  const Matrix pressure = field("pressure", 1), shear = field("tangential_stress", 3);
  Answer result{solution.outputs, contact.dual().points, Matrix(4, contact.dual().nodes())};
  for (Index k = 0; k < contact.dual().nodes(); ++k) {
    result.tractions(0, k) = pressure(0, contact.dual().vertices[k]);
    result.tractions.col(k).tail(3) = shear.col(contact.dual().vertices[k]);
  }
  return result;
}

/// Pressed, and moved by `aside` along y, onto a rigid sphere.
std::string pressed(const std::string &aside, const std::string &friction,
                    const std::string &planes, const std::string &mirror) {
  return "parameters: {push: {range: [0, 1], default: 0.05}}\n"
         "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
         "imposed: {top: {at: z1, ux: 0, uy: " +
         aside + ", uz: -push}" + planes + "}\ncontact: {foot: {at: z0, friction: {" + friction +
         "}, against: {sphere: {center: [0, 0, -4], radius: 4}}}}\n"
         "outputs:\n  held: {at: foot, measure: stick}\n  lowered: {at: foot, integral: pressure "
         "* uz}\n"
         "  turn x: {moment: x, about: [0.2, 0.1, 0.3]}\n  turn y: {moment: y, about: [0.2, 0.1, "
         "0.3]}\n  turn z: {moment: z, about: [0.2, 0.1, 0.3], of: friction}\nsmall: yes\n" +
         mirror;
}

void expect_same(const Answer &part, const Answer &whole) {
  constexpr double tolerance = 1e-9;
  for (const OutputColumn &column : output_columns()) {
    if (column.kind == OutputKind::check && !column.name.ends_with("_nodes")) continue;
    const std::optional<double> own = column.of(part.outputs), other = column.of(whole.outputs);
    if (!own) {
      EXPECT_LE(std::abs(other.value_or(0)), tolerance * *whole.outputs.normal_force)
          << column.name << " cancels";
      continue;
    }
    EXPECT_NEAR(*own, other.value(), tolerance * std::max(std::abs(*own), 1e-3)) << column.name;
  }
  EXPECT_EQ(part.outputs.slip_directions, whole.outputs.slip_directions);
  for (std::size_t k = 0; k < part.outputs.named.size(); ++k)
    EXPECT_NEAR(part.outputs.named[k].value, whole.outputs.named[k].value, tolerance);
  const double largest = whole.tractions.cwiseAbs().maxCoeff();
  for (std::size_t k = 0; k < part.points.size(); ++k) {
    const auto same = std::ranges::find_if(
        whole.points, [&](const Point &x) { return norm(x - part.points[k]) < 1e-12; });
    ASSERT_NE(same, whole.points.end());
    const Vector of_part = part.tractions.col(static_cast<Index>(k)),
                 of_whole = whole.tractions.col(same - whole.points.begin());
    EXPECT_LE((of_part - of_whole).norm(), tolerance * largest);
  }
}

const std::vector<std::string> laws{"coulomb: 0.1", "coulomb: 1", "coulomb: 0.5, limit: 0.2",
                                    "tresca: 0.05", "tresca: 0.05, bound: contact"};

TEST(SolidHalves, AQuarterHasTheAnswerOfTheWhole) {
  for (const std::string &law : laws) {
    const Answer whole = answer({true, true, false}, pressed("0", law, "", ""));
    const Answer quarter =
        answer({}, pressed("0", law, ", across x: {at: x0, ux: 0}, across y: {at: y0, uy: 0}",
                           "mirror: {x: 0, y: 0}\n"));
    EXPECT_GT(*whole.outputs.tangential_force, 0.001) << law;
    EXPECT_FALSE(quarter.outputs.force_x || quarter.outputs.force_y);
    expect_same(quarter, whole);
  }
}

TEST(SolidHalves, AHalfThatIsMovedAlongItsPlaneHasTheAnswerOfTheWhole) {
  for (const std::string &law : laws) {
    const Answer whole = answer({true, true, false}, pressed("0.03", law, "", ""));
    const Answer half =
        answer({false, true, false},
               pressed("0.03", law, ", across x: {at: x0, ux: 0}", "mirror: {x: 0}\n"));
    EXPECT_GT(std::abs(*whole.outputs.force_y), 0.005) << law;
    EXPECT_FALSE(half.outputs.force_x);
    expect_same(half, whole);
  }
}

/// Guides on both sides let a block slide along them: nothing is on them but the pressure across.
TEST(SolidHalves, BetweenGuidesABlockIsThatOfPlaneStrain) {
  constexpr double lambda = 15 * 0.35 / (1.35 * 0.3), modulus = 15 / 2.7,
                   pressure = (lambda + 2 * modulus) * 0.01;
  for (const double shear : {0.002, 0.5}) {
    const Answer of = answer({}, "parameters: {unused: {range: [0, 1], default: 0.05}}\n"
                                 "materials: {rubber: {at: all, E: 15, nu: 0.35 + 0 * unused}}\n"
                                 "let: {most: 0.3 * " +
                                     std::to_string(pressure) + " / " + std::to_string(modulus) +
                                     ", shear: " + std::to_string(shear) +
                                     ", along: 'max(0, shear - most) + min(shear, most) * z'}\n"
                                     "imposed:\n  hull: {at: [x0, x1, z1], ux: along, uy: 0, uz: "
                                     "-0.01 * z}\n  guides: {at: [y0, y1], uy: 0}\n"
                                     "contact: {floor: {at: z0, friction: {coulomb: 0.3}, against: "
                                     "{plane: {normal: [0, 0, -1], position: 0}}}}\n");
    const double traction = std::min(shear * modulus, 0.3 * pressure);
    EXPECT_NEAR(*of.outputs.normal_force, pressure, 1e-6);
    EXPECT_NEAR(*of.outputs.force_x, -traction, 1e-6) << "the nodes at the guides have their share";
    EXPECT_NEAR(*of.outputs.tangential_force, traction, 1e-6);
  }
}

TEST(SolidHalves, WhatIsMetIsItsOwnImage) {
  std::string sections =
      pressed("0.03", "coulomb: 0.2", ", across x: {at: x0, ux: 0}", "mirror: {x: 0}\n");
  sections.replace(sections.find("[0, 0, -4]"), 10, "[0.1, 0, -4]");
  EXPECT_TRUE(refuses("is not its own image", [&] { answer({false, true, false}, sections); }));
}

} // namespace
} // namespace rbvi::solid_halves_test
