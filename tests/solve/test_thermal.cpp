// Strains without stress: bodies that a temperature widens, against closed forms.
#include "../mesh/temporary_file.hpp"
#include "../ring_mesh.hpp"
#include "rbvi/element/cell_fields.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/scene/case.hpp"
#include "rbvi/solve/high_fidelity.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rbvi::thermal_test {
namespace {

constexpr double pi = std::numbers::pi;

/// A section of radii, or between x = 1 and 2, of height 1: hot by t, E = 3, alpha = 0.01.
Scene hot(const std::string &physics, const std::string &imposed, const std::string &position,
          const std::string &material = "E: 3, nu: 0.3") {
  return make_scene(
      read_case("rbvi: 1\nphysics: " + physics +
                    "\nmesh: {file: ring.msh}\nparameters: {t: {range: [-1, 2], default: 1}}\n"
                    "materials: {steel: {at: all, " +
                    material + ", expansion: 0.01, temperature: t}}\nimposed: " + imposed +
                    "\ncontact: {lid: {at: top, against: {plane: {normal: [0, 1], position: " +
                    position + "}}}}\n",
                "case.yaml"),
      {});
}

struct Answer {
  HfSolution solution;
  Matrix stresses; ///< of this rank's cells
  double largest_error = 0;
};

template <class Exact> Answer solve(const Scene &scene, double t, const Exact &exact) {
  const TemporaryFile file(ring_mesh({1, 2, 0, 1, 8, 8}));
  Problem problem(PETSC_COMM_WORLD, scene, {file.name(), 0});
  Answer answer{HighFidelity(problem, {}).solve({t}), {}};
  const Mesh &mesh = problem.mesh();
  Matrix points(std::ssize(mesh.points), 2);
  Vector u = Vector::Zero(3 * points.rows());
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const auto row = static_cast<Index>(v);
    points.row(row) << mesh.points[v][0], mesh.points[v][1];
    u.segment<2>(3 * row) = answer.solution.u.segment<2>(2 * mesh.natural_node[v]);
    const Point wanted = exact(mesh.points[v]);
    answer.largest_error = std::max({answer.largest_error, std::abs(u[3 * row] - wanted[0]),
                                     std::abs(u[3 * row + 1] - wanted[1])});
  }
  std::vector<int> cells;
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    const auto nodes = nodes_of(mesh, k);
    cells.insert(cells.end(), nodes.begin(), nodes.begin() + 6);
  }
  answer.stresses = centre_stresses(scene, {t}, points, cells, {}, u);
  return answer;
}

/// Thin and free to widen: no stress, by E and nu or by Lame's constants.
TEST(Thermal, FreeExpansionHasNoStress) {
  for (const std::string material : {"E: 3, nu: 0.3", "lambda: 2, mu: 1.5"}) {
    const Answer answer =
        solve(hot("plane_stress", "{bottom: {at: bottom, uy: 0}, inner: {at: inner, ux: 0}}", "5",
                  material),
              1.5, [](const Point &x) {
                return Point{0.015 * (x[0] - 1), 0.015 * x[1], 0};
              });
    EXPECT_LE(answer.largest_error, 1e-14);
    EXPECT_LE(answer.stresses.lpNorm<Eigen::Infinity>(), 1e-13);
    EXPECT_EQ(answer.solution.outputs.normal_force.value(), 0);
  }
}

/// Between a bottom and a lid that is 0.01 away, free at its sides: E (alpha t - 0.01).
TEST(Thermal, AHeldBarIsPressed) {
  const double pressure = 3 * (0.02 - 0.01);
  for (const std::string physics : {"plane_stress", "axisymmetric"}) {
    const bool turned = physics == "axisymmetric";
    const double radial = 0.02 + 0.3 * pressure / 3;
    const Answer answer = solve(
        hot(physics,
            turned ? "{b: {at: bottom, uy: 0}}" : "{b: {at: bottom, uy: 0}, i: {at: inner, ux: 0}}",
            "1.01"),
        2, [&](const Point &x) {
          return Point{radial * (x[0] - (turned ? 0 : 1)), 0.01 * x[1], 0};
        });
    EXPECT_LE(answer.largest_error, 1e-13);
    EXPECT_NEAR(answer.solution.outputs.normal_force.value(), pressure * (turned ? 3 * pi : 1),
                1e-12);
    EXPECT_LE((answer.stresses.col(1).array() + pressure).abs().maxCoeff(), 1e-12);
    EXPECT_LE(answer.stresses.col(0).lpNorm<Eigen::Infinity>(), 1e-12);
    EXPECT_LE(answer.stresses.col(2).lpNorm<Eigen::Infinity>(), 1e-12);
  }
}

/// A long ring that its outer side holds: u = A (r - b^2 / r) with no stress at r = a; to what 8
/// edges across leave.
TEST(Thermal, AHeldRingIsLames) {
  const auto [lambda, shear] = lame(3, 0.3);
  const double heat = (3 * lambda + 2 * shear) * 0.01,
               slope = heat / (2 * (lambda + shear) + 8 * shear);
  for (const std::string material : {"E: 3, nu: 0.3", "lambda: 45/26, mu: 15/13"}) {
    const Answer answer =
        solve(hot("axisymmetric", "{b: {at: bottom, uy: 0}, o: {at: outer, ux: 0}}", "1", material),
              1, [&](const Point &x) {
                return Point{slope * (x[0] - 4 / x[0]), 0, 0};
              });
    EXPECT_LE(answer.largest_error, 2e-4 * 3 * slope);
    const double pressure = heat - 2 * lambda * slope;
    EXPECT_NEAR(answer.solution.outputs.normal_force.value(), 3 * pi * pressure, 1e-5 * pressure);
    EXPECT_LE((answer.stresses.col(1).array() + pressure).abs().maxCoeff(), 5e-3 * pressure);
  }
}

} // namespace
} // namespace rbvi::thermal_test
