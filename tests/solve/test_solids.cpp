// Bodies in space on something rigid: patch tests with friction in any direction, answers that turn
// with the body, moments that vanish, mirror images, and what is refused.
#include "../core/refuses.hpp"
#include "../cube_mesh.hpp"
#include "../mesh/temporary_file.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/scene/case.hpp"
#include "rbvi/solve/high_fidelity.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace rbvi::solids_test {
namespace {

Scene scene_of(const std::string &sections, int degree = 2) {
  return make_scene(read_case("rbvi: 1\nphysics: solid\nmesh: {file: cube.msh, degree: " +
                                  std::to_string(degree) + "}\n" + sections,
                              "cube.yaml"));
}

HfSolution solved(const TemporaryFile &mesh, const Scene &scene, const Mu &mu,
                  MPI_Comm comm = PETSC_COMM_WORLD) {
  Problem problem(comm, scene, {mesh.name()});
  return HighFidelity(problem, {}).solve(mu);
}

/// A cube of height 1 whose top and sides are moved linearly in z onto the plane z = 0: its foot
/// sticks, or slips by what the top is moved beyond `most`.
const std::string patch = "parameters:\n"
                          "  shear: {range: [0, 1], default: 0}\n"
                          "  angle: {range: [0, 7], default: 0}\n"
                          "let:\n"
                          "  lambda: 15 * 0.35 / (1.35 * 0.3)\n"
                          "  modulus: 15 / 2.7\n"
                          "  push: (lambda + 2 * modulus) * 0.01\n"
                          "  most: 0.3 * push / modulus\n"
                          "  along: max(0, shear - most) + min(shear, most) * z\n"
                          "materials: {rubber: {at: all, E: 15, nu: 0.35}}\n"
                          "imposed:\n"
                          "  hull: {at: [x0, x1, y0, y1, z1], ux: along * cos(angle), uy: along * "
                          "sin(angle), uz: -0.01 * z}\n"
                          "contact:\n"
                          "  floor: {at: z0, against: {plane: {normal: [0, 0, -1], position: 0}}, "
                          "friction: {coulomb: 0.3}}\n";

TEST(Solids, AUniformStressIsExactInEveryDirection) {
  const TemporaryFile mesh(cube_mesh(3, 0.2));
  constexpr double lambda = 15 * 0.35 / (1.35 * 0.3), modulus = 15 / 2.7,
                   pressure = (lambda + 2 * modulus) * 0.01, most = 0.3 * pressure / modulus;
  for (const int degree : {1, 2})
    for (const double angle : {0.0, 0.6, std::numbers::pi / 4, 4.0})
      for (const double shear : {0.5 * most, 3 * most}) {
        const Outputs of = solved(mesh, scene_of(patch, degree), {shear, angle}).outputs;
        // Two triangles at corners cannot move at all, of degree 1: they carry nothing.
        const double area = degree == 1 ? 8.0 / 9 : 1,
                     traction = std::min(shear, most) * modulus * area;
        EXPECT_NEAR(*of.normal_force, pressure * area, 1e-12);
        EXPECT_NEAR(*of.force_z, pressure * area, 1e-12);
        EXPECT_NEAR(*of.tangential_force, traction, 1e-12) << "a pyramid would depend on the angle";
        EXPECT_NEAR(*of.force_x, -traction * std::cos(angle), 1e-12);
        EXPECT_NEAR(*of.force_y, -traction * std::sin(angle), 1e-12);
        EXPECT_NEAR(*of.contact_measure, area, 1e-12);
        EXPECT_EQ(*of.stick_nodes, shear < most ? *of.contact_nodes : 0);
        EXPECT_LE(*of.kkt_residual, 1e-10);
      }
}

/// A cube pressed and sheared onto a rigid sphere, all of it turned about the axis (1, 2, 2) / 3 by
/// an angle, with its mesh: the tangents of its nodes are those of the mesh, which is not.
Outputs turned(const TemporaryFile &mesh, double angle, const std::string &friction) {
  const double c = std::cos(angle), s = std::sin(angle);
  const std::array<double, 3> k{1.0 / 3, 2.0 / 3, 2.0 / 3};
  const auto entry = [&](std::size_t i, std::size_t j) {
    const std::size_t other = 3 - i - j;
    const double turn = i == j ? c : ((j + 3 - i) % 3 == 1 ? -s : s) * k[other];
    return formatted("%.17g", turn + (1 - c) * k[i] * k[j]);
  };
  const auto image = [&](const std::array<std::string, 3> &x) {
    std::array<std::string, 3> y;
    for (std::size_t i = 0; i < 3; ++i)
      y[i] = "(" + entry(i, 0) + ") * (" + x[0] + ") + (" + entry(i, 1) + ") * (" + x[1] + ") + (" +
             entry(i, 2) + ") * (" + x[2] + ")";
    return y;
  };
  const auto map = image({"x", "y", "z"}), u = image({"0.02", "0.03", "-push"}),
             centre = image({"0.45", "0.6", "-4"});
  const Scene scene = scene_of("parameters: {push: {range: [0, 1], default: 0.05}}\n"
                               "map: ['" +
                               map[0] + "', '" + map[1] + "', '" + map[2] +
                               "']\n"
                               "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
                               "imposed: {top: {at: z1, ux: '" +
                               u[0] + "', uy: '" + u[1] + "', uz: '" + u[2] +
                               "'}}\n"
                               "contact: {foot: {at: z0, friction: {" +
                               friction + "}, against: {sphere: {center: ['" + centre[0] + "', '" +
                               centre[1] + "', '" + centre[2] + "'], radius: 4}}}}\nsmall: yes\n");
  return solved(mesh, scene, {0.05}).outputs;
}

TEST(Solids, AnswersTurnWithTheBody) {
  const TemporaryFile mesh(cube_mesh(6, 0.1));
  for (const std::string friction : {"coulomb: 0.3", "tresca: 0.05, bound: contact"}) {
    const Outputs straight = turned(mesh, 0, friction);
    EXPECT_GT(*straight.contact_nodes, 8);
    EXPECT_GT(*straight.tangential_force, 0.02);
    for (const double angle : {37.0, 90.0, 211.0}) {
      const Outputs other = turned(mesh, angle * std::numbers::pi / 180, friction);
      for (const auto member :
           {&Outputs::energy, &Outputs::normal_force, &Outputs::tangential_force,
            &Outputs::contact_measure, &Outputs::peak_pressure, &Outputs::contact_nodes,
            &Outputs::stick_nodes})
        EXPECT_NEAR(*(other.*member), *(straight.*member), 1e-9 * std::abs(*(straight.*member)));
      const auto size = [](const Outputs &of) {
        return std::hypot(*of.force_x, *of.force_y, *of.force_z);
      };
      EXPECT_NEAR(size(other), size(straight), 1e-9 * size(straight));
    }
  }
}

/// A cube on the plane z = 0 that contact alone holds along z, or that is held all round.
double pressed(const TemporaryFile &mesh, const std::string &material, const std::string &rest) {
  return *solved(mesh,
                 scene_of("parameters: {load: {range: [0, 1], default: 1}}\n"
                          "materials: {rubber: {at: all, E: 15, nu: 0.3" +
                          material +
                          "}}\n"
                          "contact: {floor: {at: z0, against: {plane: {normal: [0, 0, -1], "
                          "position: 0}}}}\n" +
                          rest),
                 {1})
              .outputs.normal_force;
}

/// Each kind of load by itself: what stands on the floor is its force.
TEST(Solids, ContactCarriesEveryKindOfLoad) {
  const TemporaryFile mesh(cube_mesh(3, 0.2));
  const std::string guided = "imposed:\n  x: {at: x0, ux: 0}\n  y: {at: y0, uy: 0}\n";
  EXPECT_NEAR(pressed(mesh, "", guided + "loads: {weight: {at: all, force: [0, 0, -2*load]}}\n"), 2,
              1e-9);
  EXPECT_NEAR(pressed(mesh, "", guided + "loads: {push: {at: z1, pressure: 0.5*load}}\n"), 0.5,
              1e-9);
  EXPECT_NEAR(pressed(mesh, "", guided + "loads: {push: {at: z1, traction: [0, 0, -load]}}\n"), 1,
              1e-9);
  EXPECT_NEAR(pressed(mesh, "", guided + "  top: {at: z1, force_z: -3*load}\n"), 3, 1e-9);
  EXPECT_NEAR(pressed(mesh, "", guided + "springs: {bolt: {at: z1, pretension: 0.7*load}}\n"), 0.7,
              1e-9);
  const std::string held = "imposed:\n  x: {at: [x0, x1], ux: 0}\n  y: {at: [y0, y1], uy: 0}\n"
                           "  z: {at: z1, uz: 0}\n";
  EXPECT_NEAR(pressed(mesh, ", expansion: 0.001, temperature: load", held), 15 * 0.001 / 0.4, 1e-9)
      << "E alpha T / (1 - 2 nu)";
}

/// A cube pressed and sheared onto a rigid sphere.
Scene sheared(const std::string &friction) {
  return scene_of("parameters: {push: {range: [0, 1], default: 0.05}}\n"
                  "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
                  "imposed: {top: {at: z1, ux: 0.02, uy: 0.03, uz: -push}}\n"
                  "contact: {foot: {at: z0, " +
                  friction +
                  "against: {sphere: {center: [0.45, 0.6, -1], radius: 1}}}}\nsmall: yes\n");
}

/// Without friction every force goes through the centre of the sphere.
TEST(Solids, ThereIsNoMomentAboutARigidSphere) {
  const TemporaryFile mesh(cube_mesh(6, 0.1));
  const Scene scene = sheared("");
  Problem problem(PETSC_COMM_WORLD, scene, {mesh.name()});
  const HfSolution solution = HighFidelity(problem, {}).solve({0.05});
  Point moment{}, sum{};
  for (const PointForce &at :
       problem.contact().interfaces.front()->point_forces({0.05}, {}, solution.lambda)) {
    moment = moment + cross(at.at - Point{0.45, 0.6, -1}, at.force);
    sum = sum + at.force;
  }
  EXPECT_GT(norm(sum), 0.1);
  EXPECT_LE(norm(moment), 1e-10 * norm(sum));
  EXPECT_NEAR(norm(sum - Point{*solution.outputs.force_x, *solution.outputs.force_y,
                               *solution.outputs.force_z}),
              0, 1e-12);
}

/// The half x <= 1/2 of a cube that is pressed straight down, with its image: the numbers of the
/// whole.
TEST(Solids, AHalfHasTheNumbersOfTheWhole) {
  const TemporaryFile mesh(cube_mesh(6));
  const auto of = [&](const std::string &map, const std::string &sides, const std::string &mirror) {
    return solved(mesh,
                  scene_of("parameters: {push: {range: [0, 1], default: 0.04}}\n" + map +
                           "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
                           "imposed: {top: {at: z1, ux: 0, uy: 0, uz: -push}" +
                           sides +
                           "}\n"
                           "contact: {foot: {at: z0, against: {sphere: {center: [1, 0.5, -2], "
                           "radius: 2}}}}\n"
                           "outputs:\n  held: {reaction: [0, 0, 1], at: z1}\n"
                           "  volume: {in: all, integral: 1}\nsmall: yes\n" +
                           mirror),
                  {0.04})
        .outputs;
  };
  const Outputs half = of("", ", plane: {at: x1, ux: 0}", "mirror: {x: 1}\n");
  const Outputs whole = of("map: [2*x, y, z]\n", "", "");
  EXPECT_NEAR(half.named[1].value, 2, 1e-12);
  EXPECT_NEAR(half.named[0].value, -*half.force_z, 1e-9 * *half.force_z);
  EXPECT_FALSE(half.force_x.has_value());
  EXPECT_NEAR(*half.force_z, *whole.force_z, 0.03 * *whole.force_z) << "of a mesh twice as coarse";
  EXPECT_NEAR(*half.energy, *whole.energy, 0.03 * *whole.energy);
}

TEST(Solids, OutputsOverTheBodyAndContact) {
  const TemporaryFile mesh(cube_mesh(4, 0.2));
  const Outputs of = solved(mesh,
                            scene_of(patch + "outputs:\n"
                                             "  first: {at: z1, integral: x * y}\n"
                                             "  second: {in: all, integral: x * z^2}\n"
                                             "  area: {at: floor, integral: 1}\n"
                                             "  lever: {at: floor, integral: x * pressure}\n"
                                             "  part: {at: z1, measure: x + y < 0.5}\n"
                                             "  shear stress: {point: [0.3, 0.2, 0.4], value: "
                                             "sigma_xz}\n"
                                             "  out: {at: x0, mean: nx}\n"
                                             "  held: {at: floor, measure: stick}\n"),
                            {0.001, 0})
                         .outputs;
  const double modulus = 15 / 2.7, pressure = (15 * 0.35 / (1.35 * 0.3) + 2 * modulus) * 0.01;
  const std::vector<double> expected{0.25,  1.0 / 6,         1,    pressure / 2,
                                     0.125, modulus * 0.001, -1.0, 1};
  for (std::size_t k = 0; k < expected.size(); ++k) {
    // Where a condition ends is seen on three lines across each triangle.
    const double tolerance = of.named[k].name == "part" ? 0.1 : 1e-9;
    EXPECT_NEAR(of.named[k].value, expected[k], tolerance * std::abs(expected[k]))
        << of.named[k].name;
  }
}

/// Any number of ranks finds the same answer.
TEST(Solids, AnswersDoNotDependOnRanks) {
  const TemporaryFile mesh(cube_mesh(5, 0.1));
  const Scene scene = sheared("friction: {coulomb: 0.2}, ");
  const HfSolution world = solved(mesh, scene, {0.05}),
                   alone = solved(mesh, scene, {0.05}, PETSC_COMM_SELF);
  EXPECT_LE((world.u - alone.u).norm(), 1e-9 * alone.u.norm());
  EXPECT_LE((world.lambda - alone.lambda).norm(), 1e-9 * alone.lambda.norm());
}

/// SNES bounds single unknowns, in frames of the normals, of nodes on a fixed side with two
/// components or one.
TEST(Solids, BoundsOnSingleUnknownsFindTheSame) {
  const TemporaryFile mesh(cube_mesh(5, 0.1));
  const Scene scene =
      scene_of("parameters: {push: {range: [0, 1], default: 0.05}}\n"
               "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
               "imposed: {top: {at: z1, ux: 0, uy: 0, uz: -push}, left: {at: x0, ux: 0}, "
               "front: {at: y0, uy: 0}}\n"
               "contact: {foot: {at: z0, lumped: yes, against: {sphere: {center: [0.1, 0.2, -1], "
               "radius: 1}}}}\nsmall: yes\n",
               1);
  Problem problem(PETSC_COMM_WORLD, scene, {mesh.name()});
  HfOptions vi;
  vi.method = HfMethod::vi;
  const HfSolution bounded = HighFidelity(problem, vi).solve({0.12}),
                   found = HighFidelity(problem, {}).solve({0.12});
  EXPECT_GT(*found.outputs.contact_nodes, 4);
  EXPECT_LE((bounded.u - found.u).norm(), 1e-10 * found.u.norm());
  EXPECT_LE((bounded.lambda - found.lambda).norm(), 1e-9 * found.lambda.norm());
}

/// A sweep with one factorisation finds what single solves do.
TEST(Solids, ASweepOfSizesHasTheAnswersOfSingleSolves) {
  const TemporaryFile mesh(cube_mesh(5, 0.1));
  const Scene scene =
      scene_of("parameters:\n  size: {range: [0.5, 2], default: 1}\n"
               "  young: {range: [5, 50], default: 15}\n"
               "map: {scale: size}\n"
               "materials: {rubber: {at: all, E: young, nu: 0.3}}\n"
               "loads: {weight: {at: all, force: [0, 0, -0.1]}}\n"
               "imposed: {top: {at: z1, ux: 0.02*size, uy: 0.03, uz: -0.05*size}}\n"
               "contact: {foot: {at: z0, friction: {coulomb: 0.2}, against: {sphere: {center: "
               "[0.45*size, 0.6*size, -size], radius: size}}}}\nsmall: yes\n");
  Problem problem(PETSC_COMM_WORLD, scene, {mesh.name()});
  HighFidelity sweep(problem, {});
  for (const Mu &mu : {Mu{1, 15}, Mu{0.7, 20}, Mu{1.6, 8}, Mu{1.2, 40}}) {
    const HfSolution one = sweep.solve(mu), alone = solved(mesh, scene, mu);
    EXPECT_LE((one.u - alone.u).norm(), 1e-10 * alone.u.norm());
    EXPECT_LE((one.lambda - alone.lambda).norm(), 1e-9 * alone.lambda.norm());
  }
}

TEST(Solids, RefusesWhatIsPlane) {
  const std::string body = "parameters: {push: {range: [0, 1], default: 0.05}}\n"
                           "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
                           "imposed: {top: {at: z1, ux: 0, uy: 0, uz: -push}}\n";
  const auto expect = [&](const std::string &says, const std::string &contact) {
    EXPECT_TRUE(refuses(says, [&] { (void)scene_of(body + contact); }));
  };
  expect("a solid meets one of plane", "contact: {foot: {at: z0, against: {disk: {center: [0, 0], "
                                       "radius: 1}}}}\n");
  expect("a list of 3 numbers",
         "contact: {foot: {at: z0, against: {plane: {normal: [0, -1], position: 0}}}}\n");
  expect("kinematics: large", "contact: {foot: {at: z0, kinematics: large, against: {plane: "
                              "{normal: [0, 0, -1], position: 0}}}}\n");
  expect("two solids", "contact: {foot: {at: z0, against: z1}}\n");
  expect("a plane in space is tilted",
         "contact: {foot: {at: z0, against: {plane: {normal: [0, 0, -1], position: 0, tilt: "
         "push}}}}\n");
}

} // namespace
} // namespace rbvi::solids_test
