// Bodies that are turned about x = 0, against closed forms: Lame's cylinder, cylinders under an
// axial pressure, Hertz' sphere.
#include "../core/refuses.hpp"
#include "../mesh/temporary_file.hpp"
#include "../ring_mesh.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/element/cell_fields.hpp"
#include "rbvi/fem/assembly.hpp"
#include "rbvi/scene/case.hpp"
#include "rbvi/solve/high_fidelity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rbvi::axisymmetric_test {
namespace {

constexpr double pi = std::numbers::pi, young = 3;

Scene scene_of(const std::string &sections) {
  return make_scene(read_case("rbvi: 1\nphysics: axisymmetric\n" + sections, "case.yaml"), {});
}

/// Largest |u - exact(x)| over the nodes, the motion included. Collective.
template <class Exact>
double displacement_error(const Problem &problem, const Mu &mu, const HfSolution &s,
                          const Exact &exact) {
  const Mesh &mesh = problem.mesh();
  const FullMu all = expand(problem.scene().parameters, mu);
  double worst = 0;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const Point &x = mesh.points[v];
    const Point motion = problem.scene().motion ? problem.scene().motion(all, x) : Point{};
    const Point wanted = exact(problem.scene().map(all, x));
    for (std::size_t c = 0; c < 2; ++c)
      worst = largest(
          {worst, std::abs(motion[c] + s.u[2 * mesh.natural_node[v] + Index(c)] - wanted[c])});
  }
  MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE, MPI_MAX, problem.comm());
  return worst;
}

/// A long tube of radii 1 and 2 under an outer pressure, between a bottom and a rigid plane that
/// hold its length: Lame's plane strain, pressed on the plane by 2 nu p b^2 / (b^2 - a^2).
struct Tube {
  double nu, pressure, scale = 1;
  double factor() const { return pressure * 4 / 3.0; } // p b^2 / (b^2 - a^2)
  Point displacement(const Point &x) const {
    const double r = x[0] / scale;
    return {-scale * (1 + nu) / young * factor() * ((1 - 2 * nu) * r + 1 / r), 0, 0};
  }
  double axial_force() const { return 2 * nu * factor() * 3 * pi * scale * scale; }
  double hoop(double r) const { return -factor() * (1 + scale * scale / (r * r)); }
};

const std::string tube_sections =
    "parameters: {p: {range: [0.1, 1], default: 0.5}, s: {range: [0.5, 2], default: 1}, "
    "nu: {range: [0.1, 0.4999], default: 0.3}}\n"
    "map: {scale: s}\n"
    "materials: {steel: {at: all, E: 3, nu: nu}}\n"
    "imposed: {bottom: {at: bottom, uy: 0}}\n"
    "loads: {outer: {at: outer, pressure: p}}\n";

Scene tube(int degree, const std::string &formulation = "mixed") {
  return scene_of("mesh: {file: ring.msh, degree: " + std::to_string(degree) + "}\n" +
                  tube_sections + "contact: {lid: {at: top, formulation: " + formulation +
                  ", against: {plane: {normal: [0, 1], position: s}}}}\n");
}

/// Relative errors.
struct TubeErrors {
  double displacement, force, pressure, energy;
};

TubeErrors tube_errors(const Scene &scene, int edges, const Mu &mu) {
  const TemporaryFile file(ring_mesh({1, 2, 0, 1, edges, edges}));
  Problem problem(PETSC_COMM_WORLD, scene, {file.name(), 0});
  const HfSolution s = HighFidelity(problem, {}).solve(mu);
  const Tube exact{mu[2], mu[0], mu[1]};
  const auto relative = [](double value, double wanted) { return std::abs(value / wanted - 1); };
  const auto u = [&](const Point &x) { return exact.displacement(x); };
  EXPECT_NEAR(s.outputs.contact_measure.value(), 3 * pi * mu[1] * mu[1], 1e-12);
  EXPECT_FALSE(s.outputs.contact_half_width || s.outputs.centre_pressure ||
               s.outputs.horizontal_reaction);
  EXPECT_NEAR(s.outputs.reaction.value(), -s.outputs.normal_force.value(),
              1e-10 * s.outputs.normal_force.value());
  EXPECT_LE(s.kkt.largest(), 1e-10);
  // J = -f(u) / 2, the work of the outer pressure
  const double energy =
      mu[0] * exact.displacement({2 * mu[1], 0, 0})[0] * 2 * pi * 2 * mu[1] * mu[1] / 2;
  return {displacement_error(problem, mu, s, u) / std::abs(exact.displacement({mu[1], 0, 0})[0]),
          relative(*s.outputs.normal_force, exact.axial_force()),
          relative(*s.outputs.peak_pressure, exact.axial_force() / (3 * pi * mu[1] * mu[1])),
          relative(*s.outputs.energy, energy)};
}

/// The largest error at a node is of the order h^2 |log h| by degree 1. The axial force follows
/// from the loads alone: u_y is linear.
TEST(Axisymmetric, LamesTubeConvergesInItsOrder) {
  for (const std::string formulation : {"mixed", "nitsche"})
    for (const int degree : {1, 2}) {
      SCOPED_TRACE(formulation + std::to_string(degree));
      const Scene scene = tube(degree, formulation);
      const Mu mu{0.5, 1.3, 0.3};
      const TubeErrors coarse = tube_errors(scene, 8, mu), fine = tube_errors(scene, 16, mu);
      EXPECT_LE(fine.force, 1e-12);
      EXPECT_GE(std::log2(coarse.displacement / fine.displacement), degree + 0.6);
      EXPECT_GE(std::log2(coarse.energy / fine.energy), 2 * degree - 0.2);
      EXPECT_GE(std::log2(coarse.pressure / fine.pressure), degree - 0.5);
      EXPECT_LE(fine.displacement, degree == 1 ? 5e-3 : 5e-5);
      EXPECT_LE(fine.energy, degree == 1 ? 5e-4 : 2e-7);
    }
}

/// The table of core/locking.cpp. Degree 2 loses an order near incompressibility and converges in
/// what is left of it, degree 1 does not converge at all on meshes that one can afford.
TEST(Axisymmetric, DegreeTwoDoesNotLock) {
  const auto energy = [](int degree, int edges, double nu) {
    return tube_errors(tube(degree), edges, {0.5, 1, nu}).energy;
  };
  EXPECT_GE(energy(1, 8, 0.499), 0.1);
  EXPECT_GE(energy(1, 16, 0.499), 0.05);
  EXPECT_LE(energy(2, 8, 0.49), 1e-4);
  EXPECT_LE(energy(2, 8, 0.499), 1e-3);
  EXPECT_LE(energy(2, 16, 0.499), 1e-4);
}

/// A solid cylinder, or two whose meshes do not match: a linear displacement is exact, on the axis,
/// too, which is held by itself.
TEST(Axisymmetric, CylindersUnderAxialPressureAreExact) {
  const std::string block = "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], "
                            "position: 0}}",
                    pair = "motion: [0, 'y > 0 ? -d : 0']\n"
                           "map: [x, 'y > 0 ? y - 0.25 : y + 0.25']\n"
                           "contact: {both: {at: slave, against: master, multiplier: ";
  for (const std::string degree : {"1", "2"})
    for (const std::string &contact :
         {block + "}}", block + ", formulation: nitsche}}", block + ", friction: {coulomb: 0.3}}}",
          pair + "p0}}", pair + "p1}}"}) {
      SCOPED_TRACE(contact + degree);
      const bool two = contact.starts_with("motion"),
                 friction = contact.find("coulomb") != std::string::npos;
      const Scene scene =
          scene_of("mesh: {built_in: " + std::string(two ? "two_blocks" : "one_block") +
                   ", degree: " + degree +
                   "}\nparameters: {d: {range: [0.01, 0.1], default: 0.05}}\n"
                   "materials: {steel: {at: all, E: 3, nu: " +
                   (friction ? "0" : "0.35") +
                   "}}\n"
                   "imposed: {top: {at: top, uy: " +
                   (two ? "motion" : "-d") + "}" + (two ? ", bottom: {at: bottom, uy: 0}" : "") +
                   "}\n" + contact + "\n");
      Problem problem(PETSC_COMM_WORLD, scene, {});
      const Mu mu{0.04};
      const HfSolution s = HighFidelity(problem, {}).solve(mu);
      const double length = two ? 1 : 0.5, pressure = young * 0.04 / length;
      EXPECT_NEAR(s.outputs.normal_force.value(), pi * pressure, 1e-11);
      EXPECT_NEAR(s.outputs.peak_pressure.value(), pressure, 1e-11);
      EXPECT_NEAR(s.outputs.contact_measure.value(), pi, 1e-12);
      EXPECT_NEAR(s.outputs.energy.value(), pi * pressure * 0.04 / 2, 1e-11);
      const double radial = friction ? 0 : 0.35 * 0.04 / length;
      EXPECT_LE(
          displacement_error(problem, mu, s,
                             [&](const Point &x) {
                               const double bottom = two ? -0.5 : 0;
                               return Point{radial * x[0], -0.04 / length * (x[1] - bottom), 0};
                             }),
          1e-12);
      EXPECT_LE(s.kkt.largest(), 1e-11);
    }
}

/// Two spheres of radius 1, each pressed on a rigid plane: peak, radius of contact and indentation
/// by the force. Half-spheres are no half-spaces, by the square of the radius of contact at its
/// edge, by the radius itself in the indentation; radii are known to half an edge.
TEST(Axisymmetric, SpheresAreHertz) {
  const Scene scene = scene_of(
      "mesh: {built_in: two_quarter_discs}\n"
      "parameters: {d: {range: [0.002, 0.02], default: 0.01}}\n"
      "materials: {steel: {at: all, E: 1, nu: 0.3}}\n"
      "motion: [0, 'y > 0 ? -0.5 - d : 0.5 + d']\n"
      "imposed: {top: {at: top, ux: 0, uy: motion}, bottom: {at: bottom, ux: 0, uy: motion}}\n"
      "contact: {over: {at: slave, against: {plane: {normal: [0, -1], position: 0}}},\n"
      "          under: {at: master, against: {plane: {normal: [0, 1], position: 0}}}}\n");
  Problem problem(PETSC_COMM_SELF, scene, {});
  const HfSolution s = HighFidelity(problem, {}).solve({0.01});
  const double modulus = 1 / (1 - 0.09);
  ASSERT_EQ(s.outputs.interfaces.size(), 2U);
  for (const Outputs &one : s.outputs.interfaces) {
    const double force = one.normal_force.value(), radius = std::cbrt(3 * force / (4 * modulus)),
                 peak = 1.5 * force / (pi * radius * radius);
    EXPECT_NEAR(radius, 0.1, 0.005);
    EXPECT_NEAR(one.peak_pressure.value() / peak, 1, 0.004);
    EXPECT_NEAR(std::sqrt(one.contact_measure.value() / pi), radius, 0.0008);
    EXPECT_NEAR(radius * radius / 0.01, 1, 0.06);
  }
}

TEST(Axisymmetric, TheHoopStressIsLames) {
  const TemporaryFile file(ring_mesh({1, 2, 0, 1, 8, 8}));
  Problem problem(PETSC_COMM_SELF, tube(2), {file.name(), 0});
  const Mu mu{0.5, 1.3, 0.3};
  const HfSolution s = HighFidelity(problem, {}).solve(mu);
  const Mesh &mesh = problem.mesh();
  Matrix points(std::ssize(mesh.points), 2);
  Vector u = Vector::Zero(3 * points.rows());
  std::vector<int> cells;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    points.row(Index(v)) << mesh.points[v][0], mesh.points[v][1];
    u.segment<2>(3 * Index(v)) = s.u.segment<2>(2 * mesh.natural_node[v]);
  }
  for (std::size_t k = 0; k < mesh.cells.size(); ++k)
    for (int i = 0; i < 6; ++i)
      cells.push_back(nodes_of(mesh, k)[std::size_t(i)]);
  const Tube exact{mu[2], mu[0], mu[1]};
  const Matrix stresses = centre_stresses(problem.scene(), expand(problem.scene().parameters, mu),
                                          points, cells, {}, u);
  for (Index k = 0; k < stresses.rows(); ++k) {
    const Cell cell = cell_of(mesh, std::size_t(k));
    EXPECT_NEAR(stresses(k, 2), exact.hoop(1.3 * reference_centre(cell)[0]), 5e-3);
  }
}

/// A pressed cylinder of radius 1: its stress is the same everywhere, on the axis, where u / r is a
/// limit, too. `sides` has edges on the axis.
TEST(Axisymmetric, OutputsOnTheAxisAreLimits) {
  for (const int degree : {1, 2}) {
    const Scene scene = scene_of(
        "mesh: {built_in: one_block, degree: " + std::to_string(degree) +
        "}\nparameters: {d: {range: [0.01, 0.1], default: 0.05}}\n"
        "materials: {steel: {at: all, E: 3, nu: 0.3}}\nimposed: {top: {at: top, uy: -d}}\n"
        "contact: {f: {at: contact, against: {plane: {normal: [0, -1], position: 0}}}}\n"
        "outputs:\n  along: {value: sigma_yy, point: [0, 0.21]}\n"
        "  corner: {value: sigma_yy, point: [0, 0]}\n  hoop: {value: sigma_zz, point: [0, 0.5]}\n"
        "  mantle: {integral: sigma_yy, at: sides}\n  most: {max: von_mises, at: sides}\n"
        "  stored: {integral: strain_energy, in: all}\n");
    Problem problem(PETSC_COMM_WORLD, scene, {});
    const double d = 0.03, stress = 3 * d / 0.5, near = 1e-9;
    const std::vector<NamedOutput> found = HighFidelity(problem, {}).solve({d}).outputs.named;
    ASSERT_EQ(found.size(), 6U);
    EXPECT_NEAR(found[0].value, -stress, near);
    EXPECT_NEAR(found[1].value, -stress, near);
    EXPECT_NEAR(found[2].value, 0, near);
    EXPECT_NEAR(found[3].value, -stress * pi, near);
    EXPECT_NEAR(found[4].value, stress, near);
    EXPECT_NEAR(found[5].value, stress * stress / 6 * pi / 2, near);
  }
}

TEST(Axisymmetric, AnswersDoNotDependOnTheRanks) {
  const Scene scene = tube(2);
  const TemporaryFile file(ring_mesh({1, 2, 0, 1, 6, 6}));
  Problem whole(PETSC_COMM_SELF, scene, {file.name(), 0}),
      parts(PETSC_COMM_WORLD, scene, {file.name(), 0});
  const Mu mu{0.7, 0.9, 0.4};
  const HfSolution one = HighFidelity(whole, {}).solve(mu), all = HighFidelity(parts, {}).solve(mu);
  EXPECT_LE((one.u - all.u).lpNorm<Eigen::Infinity>(), 1e-12);
  EXPECT_NEAR(one.outputs.normal_force.value(), all.outputs.normal_force.value(), 1e-11);
}

TEST(Axisymmetric, WhatCannotBeTurnedIsRefused) {
  const auto make = [](const std::string &mesh, const std::string &rest) {
    const Scene scene = scene_of("mesh: {built_in: " + mesh +
                                 "}\nparameters: {d: {range: [0.01, 0.1], default: 0.05}}\n"
                                 "materials: {steel: {at: all, E: 3, nu: 0.3}}\n" +
                                 rest);
    Problem problem(PETSC_COMM_WORLD, scene, {});
    (void)problem.assemble({0.05});
  };
  const std::string floor = "contact: {f: {at: contact, against: {plane: {normal: [0, -1], "
                            "position: 0}}}}\n",
                    top = "imposed: {top: {at: top, uy: -d}}\n";
  EXPECT_NO_THROW(make("one_block", top + floor));
  EXPECT_TRUE(refuses("lies at x >= 0", [&] { make("half_disc", top + floor); }));
  EXPECT_NO_THROW(make("one_block", "imposed: {top: {at: top, ux: 0}}\n" + floor))
      << "contact can hold it along the axis";
  EXPECT_TRUE(refuses("'x = 0' and 'sides' impose different displacements", [&] {
    make("one_block", "imposed: {top: {at: top, uy: 0}, s: {at: sides, ux: d}}\n" + floor);
  }));
  EXPECT_TRUE(
      refuses("leave out symmetric", [&] { make("one_block", "symmetric: yes\n" + top + floor); }));
  EXPECT_THROW(make("one_block", "map: [x + d, y]\n" + top + floor), Error);
}

} // namespace
} // namespace rbvi::axisymmetric_test
