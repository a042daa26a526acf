// Boundaries that move as one under a total force.
#include "../core/refuses.hpp"
#include "rbvi/fem/assembly.hpp"
#include "rbvi/scene/case.hpp"
#include "rbvi/solve/high_fidelity.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace rbvi::total_force_test {
namespace {

/// A wheel on a fixed bottom whose hub is lifted: its top meets a plane.
Scene wheel(const std::string &hub, const std::string &more = "") {
  return make_scene(
      read_case(
          "rbvi: 1\nphysics: plane_strain\nmesh: {built_in: annulus}\n"
          "parameters: {f: {range: [0.1, 3], default: 1}, d: {range: [0, 1], default: 0.1}}\n"
          "require: {both: {that: f + d > 0, says: no}}\n"
          "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
          "imposed: {bottom: {at: bottom, ux: 0, uy: 0}, hub: {at: hub, " +
              hub + "}" + more +
              "}\ncontact: {lid: {at: top, against: {plane: {normal: [0, 1], position: 1}}}}\n",
          "case.yaml"),
      {});
}

/// The force that the body resists with at the nodes of a boundary along y, of a displacement at
/// all dofs. On one rank.
double force_on(const Problem &problem, const std::string &boundary, const Mu &mu,
                const Vector &u) {
  const Mesh &mesh = problem.mesh();
  const FullMu all = expand(problem.scene().parameters, mu);
  Vector local = Vector::Zero(2 * std::ssize(mesh.points));
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    local.segment<2>(2 * static_cast<Index>(v)) = u.segment<2>(2 * mesh.natural_node[v]);
  Vector force = Vector::Zero(local.size());
  for (const Term &term : problem.scene().a) {
    double theta = 1;
    for (const Factor &factor : *term.theta)
      theta *= factor.value(all);
    force += product_with({{&term.form, theta}}, {}, mesh, problem.dofs(), {}, local);
  }
  double sum = 0;
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    if (mesh.boundary.at(boundary)[v]) sum += force[2 * static_cast<Index>(v) + 1];
  return sum;
}

TEST(TotalForce, IsBalancedAndMovesTheBoundaryAsOne) {
  Problem problem(PETSC_COMM_SELF, wheel("ux: 0, force_y: f"), {});
  const Mu mu{2, 0};
  const HfSolution s = HighFidelity(problem, {}).solve(mu);
  EXPECT_GT(s.outputs.normal_force.value(), 0.1);
  EXPECT_NEAR(force_on(problem, "hub", mu, s.u), 2, 1e-11);
  EXPECT_NEAR(force_on(problem, "bottom", mu, s.u) + 2, s.outputs.normal_force.value(), 1e-11);
  const Mesh &mesh = problem.mesh();
  std::vector<double> lifts;
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    if (mesh.boundary.at("hub")[v]) lifts.push_back(s.u[2 * mesh.natural_node[v] + 1]);
  ASSERT_GT(lifts.size(), 10U);
  EXPECT_EQ(std::ranges::max(lifts), std::ranges::min(lifts));

  // The same as by the displacement that it finds.
  Problem moved(PETSC_COMM_SELF, wheel("ux: 0, uy: d"), {});
  const HfSolution other = HighFidelity(moved, {}).solve({1, lifts.front()});
  EXPECT_LE((other.u - s.u).lpNorm<Eigen::Infinity>(), 1e-12);
  EXPECT_NEAR(other.outputs.normal_force.value(), s.outputs.normal_force.value(), 1e-11);
}

/// Two half-spheres, pressed together by a force on the whole face and held by a spring on it.
TEST(TotalForce, IsThatOfTheWholeCircumference) {
  const Scene scene = make_scene(
      read_case(
          "rbvi: 1\nphysics: axisymmetric\nmesh: {built_in: two_quarter_discs, degree: 1}\n"
          "map: [x, 'y > 0 ? y - 0.5 : y + 0.5']\n"
          "parameters: {f: {range: [0.001, 0.01], default: 0.005}}\n"
          "materials: {steel: {at: all, E: 1, nu: 0.3}}\n"
          "imposed: {top: {at: top, ux: 0, force_y: -f}, bottom: {at: bottom, ux: 0, uy: 0}}\n"
          "springs: {hold: {at: top, stiffness: 0.01}}\n"
          "contact: {balls: {at: slave, against: master}}\n",
          "case.yaml"),
      {});
  Problem problem(PETSC_COMM_SELF, scene, {});
  const HfSolution s = HighFidelity(problem, {}).solve({0.004});
  const Mesh &mesh = problem.mesh();
  std::size_t node = 0;
  while (!mesh.boundary.at("top")[node])
    ++node;
  const double lift = s.u[2 * mesh.natural_node[node] + 1];
  EXPECT_LT(lift, -0.01);
  EXPECT_NEAR(s.outputs.reaction.value(), 0.004 + 0.01 * lift, 1e-13) << "along the axis";
}

TEST(TotalForce, IsTheSameOnAnyNumberOfRanks) {
  const Scene scene = wheel("ux: 0, force_y: f*2");
  Problem whole(PETSC_COMM_SELF, scene, {}), parts(PETSC_COMM_WORLD, scene, {});
  const HfSolution one = HighFidelity(whole, {}).solve({1.3, 0}),
                   all = HighFidelity(parts, {}).solve({1.3, 0});
  EXPECT_LE((one.u - all.u).lpNorm<Eigen::Infinity>(), 1e-11);
  EXPECT_NEAR(one.outputs.energy.value(), all.outputs.energy.value(), 1e-11);
}

/// One that holds the turn of a body is not told to be free.
TEST(TotalForce, WhatItCannotBeIsRefused) {
  const auto make = [](const Scene &scene) { Problem problem(PETSC_COMM_WORLD, scene, {}); };
  EXPECT_TRUE(refuses("ux is given by force_x", [] { (void)wheel("ux: 0, force_x: f"); }));
  EXPECT_TRUE(refuses("does not depend on the place", [] { (void)wheel("ux: 0, force_y: f*x"); }));
  EXPECT_TRUE(refuses("the boundary 'rim' moves as one along y",
                      [&] { make(wheel("ux: 0, uy: 0", ", rim: {at: rim, force_y: f}")); }));
  EXPECT_TRUE(refuses("give them boundaries without common nodes",
                      [&] { make(wheel("ux: 0, uy: 0", ", top: {at: top, force_y: f}")); }));
}

} // namespace
} // namespace rbvi::total_force_test
