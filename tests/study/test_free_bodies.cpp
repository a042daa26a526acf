// Bodies that contact alone holds: against closed forms, by all solvers, and reduced.
#include "../core/refuses.hpp"
#include "reduced.hpp"

#include "rbvi/core/largest.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/scene/case.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <tuple>

#include <unistd.h>

namespace rbvi::free_bodies_test {
namespace {

using testing_reduced::Reduced;

/// A block on the floor y = 0 under the tractions of a constant stress: uniaxial strain under the
/// pressure p with the shear stress t, which a foot that sticks carries exactly. It may be drawn
/// `above` the floor.
Scene block(int degree, const std::string &friction = "friction: {coulomb: c}",
            const std::string &mesh = "one_block", double above = 0) {
  const std::string text =
      "rbvi: 1\nphysics: plane_strain\nmesh: {built_in: " + mesh +
      ", degree: " + std::to_string(degree) +
      "}\nparameters: {p: {range: [0.5, 2], default: 1}, t: {range: [-0.2, 0.2], default: 0.1}, "
      "c: {range: [0.5, 1], default: 0.5}}\n" +
      (friction.find("coulomb") == std::string::npos ? "free: p,t\n" : "") +
      "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
      "loads:\n  top: {at: top, traction: [t, -p]}\n"
      "  sides: {at: sides, traction: ['-p * 0.3 / 0.7 * nx', 't * nx']}\n"
      "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], position: " +
      std::to_string(above) + "}}" + (friction.empty() ? "" : ", " + friction) + "}}\n";
  return make_scene(read_case(text, "block.yaml"), {});
}

void expect_exact(const Problem &problem, const Mu &mu, const HfSolution &s, double sunk = 0) {
  const double pressure = mu[0], stress = mu[1], tolerance = 1e-11 * pressure;
  const Index nodes = problem.contact().nodes();
  EXPECT_LE((s.lambda.head(nodes).array() - pressure).abs().maxCoeff(), tolerance);
  EXPECT_LE((s.lambda.tail(nodes).array().abs() - std::abs(stress)).abs().maxCoeff(), tolerance);
  EXPECT_NEAR(s.outputs.normal_force.value(), pressure, tolerance) << "the balance of forces";
  EXPECT_LE(s.kkt.largest(), 1e-10);
  const Lame material = lame(15, 0.3);
  const double strain = pressure / (material.lambda + 2 * material.shear),
               shear = stress / material.shear;
  double worst = 0;
  const Mesh &mesh = problem.mesh();
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const double y = mesh.points[v][1];
    const Index dof = 2 * mesh.natural_node[v];
    worst = rbvi::largest(
        {worst, std::abs(s.u[dof] - shear * y), std::abs(s.u[dof + 1] + sunk + strain * y)});
  }
  EXPECT_LE(worst, 1e-11);
  // The energy is that of the body and of the load, without the springs.
  const double area = 0.5, density = (pressure * strain + stress * shear) / 2;
  EXPECT_NEAR(s.outputs.energy.value(), -area * density - pressure * sunk, tolerance);
}

template <class Work> std::string said(Work &&work) {
  try {
    work();
    return "";
  } catch (const Error &error) {
    return error.what();
  }
}

TEST(FreeBodies, ABlockOnAFloorIsInBalance) {
  for (const int degree : {1, 2})
    for (const HfContact how : {HfContact::condensed, HfContact::eliminated}) {
      Problem problem(PETSC_COMM_WORLD, block(degree), {});
      HfOptions options;
      options.contact = how;
      HighFidelity solver(problem, options);
      for (const Mu &mu : {Mu{1, 0.1, 0.5}, Mu{2, -0.2, 0.3}, Mu{0.5, 0, 1}})
        expect_exact(problem, mu, solver.solve(mu));
    }
}

/// It falls before anything touches.
TEST(FreeBodies, ABlockAboveAFloorFallsOntoIt) {
  Problem problem(PETSC_COMM_WORLD, block(2, "friction: {coulomb: c}", "one_block", 0.4), {});
  const Mu mu{1, 0, 0.5};
  expect_exact(problem, mu, HighFidelity(problem, {}).solve(mu), 0.4);
}

TEST(FreeBodies, UzawaFindsTheSame) {
  Problem problem(PETSC_COMM_WORLD, block(1), {});
  HfOptions options;
  options.method = HfMethod::uzawa;
  options.uzawa.accelerated = true;
  options.uzawa.tolerance = 1e-11;
  const HfSolution s = HighFidelity(problem, options).solve({1, 0.1, 0.5});
  EXPECT_NEAR(s.outputs.normal_force.value(), 1, 1e-8);
  EXPECT_NEAR(s.outputs.peak_pressure.value(), 1, 1e-6);
}

TEST(FreeBodies, WhatNothingHoldsIsRefused) {
  EXPECT_TRUE(refuses("the body can move along (1, 0): impose displacements that prevent it, for "
                      "no contact does",
                      [] { Problem(PETSC_COMM_WORLD, block(1, ""), {}); }));
  EXPECT_TRUE(refuses("by Nitsche's method contact alone holds no body", [] {
    Problem problem(PETSC_COMM_WORLD, block(1, "formulation: nitsche, nitsche_gamma0: 100"), {});
    HighFidelity(problem, {});
  }));
  Problem problem(PETSC_COMM_WORLD, block(1), {});
  HighFidelity solver(problem, {});
  EXPECT_NE(said([&] {
              solver.solve({1, 0.2, 0.1});
            }).find("is pushed where no contact and no friction can hold it"),
            std::string::npos);
  EXPECT_NE(said([&] {
              solver.solve({1, 0, 0});
            }).find("can move along (1, 0) at no cost at the answer"),
            std::string::npos);
  expect_exact(problem, {1, 0.1, 0.5}, solver.solve({1, 0.1, 0.5})); // a failure leaves no trace
}

TEST(FreeBodies, WhetherTheyAreHeldIsKnownWithoutASolve) {
  Problem problem(PETSC_COMM_WORLD, block(1), {});
  const auto motions = [&](const Mu &mu) {
    return unresisted_motions(problem, problem.assemble(mu));
  };
  EXPECT_EQ(motions({1, 0.1, 0.5}).cols(), 0);
  const Matrix without_friction = motions({1, 0, 0});
  EXPECT_EQ(describe(problem.free_bodies(), 2, without_friction), "the body can move along (1, 0)");
  EXPECT_EQ(
      said([&] {
        motions({1, 0.2, 0.1});
      }),
      "the body can move along (0.995, 0.0995), and is pushed where no contact and no friction can "
      "hold it")
      << "at right angles to the cone of friction";
  EXPECT_NE(said([&] {
              motions({-1, 0, 1});
            }).find("can move along (0, 1), and is pushed"),
            std::string::npos)
      << "up";
}

TEST(FreeBodies, AReducedBlockIsInBalance) {
  Reduced made(block(2), "grid:2,3,2");
  made.reduce(testing_reduced::everything());
  if (rank_of(PETSC_COMM_WORLD) != 0) return;
  EXPECT_EQ(made.model.body.springs.cols(), 3);
  OnlineSolver online(made.model);
  for (const Mu &mu : {Mu{1.3, 0.05, 0.8}, Mu{0.6, -0.1, 0.55}}) {
    const ReducedAnswer answer = online.solve(mu);
    const Outputs outputs = online.outputs(mu, answer);
    EXPECT_NEAR(outputs.normal_force.value(), mu[0], 1e-11);
    EXPECT_NEAR(outputs.peak_pressure.value(), mu[0], 1e-8);
    const Lame material = lame(15, 0.3);
    EXPECT_NEAR(outputs.energy.value(),
                -0.25 * (mu[0] * mu[0] / (material.lambda + 2 * material.shear) +
                         mu[1] * mu[1] / material.shear),
                1e-9);
  }
  EXPECT_NE(said([&] {
              online.solve({1, 0.2, 0.1}, true);
            }).find("is pushed where no contact and no friction can hold it"),
            std::string::npos);
  EXPECT_NE(said([&] {
              online.solve({1, 0, 0}, true);
            }).find("can move at no cost"),
            std::string::npos);
}

/// Pushed down by what is imposed and held sideways by friction alone, by a stiffness that is exact
/// or interpolated: what is read from the file answers as the full solve does.
TEST(FreeBodies, AModelOfAPushedBlockComesBackFromItsFile) {
  for (const std::string young : {"15 * (1 + grade)", "15 * exp(grade*y)"}) {
    const Scene scene = make_scene(
        read_case("rbvi: 1\nphysics: plane_strain\nmesh: {built_in: one_block, degree: 1}\n"
                  "parameters: {grade: {range: [0.1, 0.5], default: 0.2}, depth: {range: [0.01, "
                  "0.05], default: 0.03}}\nmaterials: {rubber: {at: all, E: " +
                      young +
                      ", nu: 0.3}}\nimposed: {top: {at: top, uy: -depth}}\n"
                      "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], position: "
                      "0}}, friction: {coulomb: 0.3}}}\n"
                      "outputs: {hold: {reaction: [0, 1], at: top}}\n",
                  "block.yaml"),
        {});
    const Mu mu{0.3, 0.037};
    Reduced made(scene, "grid:4,3");
    made.reduce(testing_reduced::everything());
    const double force = HighFidelity(made.problem, {}).solve(mu).outputs.normal_force.value();
    if (rank_of(PETSC_COMM_WORLD) != 0) continue;
    const auto path = std::filesystem::path(testing::TempDir()) /
                      ("rbvi_pushed_" + std::to_string(::getpid()) + ".h5");
    write_model(made.model, path);
    const ReducedModel model = read_model(path, catalogue(), false);
    std::filesystem::remove(path);
    std::filesystem::remove(fields_file(path));
    OnlineSolver online(model);
    const Outputs outputs = online.outputs(mu, online.solve(mu));
    EXPECT_NEAR(outputs.normal_force.value() / force, 1, 1e-5) << young;
    EXPECT_NEAR(outputs.named.front().value / -force, 1, 1e-5) << "down, as it is pushed";
  }
}

/// Where the condition is that of the deformed body: B is at hand at every answer, whatever steps
/// it was found by.
TEST(FreeBodies, AReducedBodyThatMovesFarIsInBalance) {
  const std::string disk = "{disk: {center: [0, -3], radius: 2}}",
                    level = "{level_set: 'hypot(x, y + 3) - 2'}",
                    pushed = "imposed: {top: {at: top, ux: 0, force_y: -press}}\n",
                    loaded = "imposed: {top: {at: top, ux: 0}}\n"
                             "loads: {top: {at: top, pressure: press/2}}\n"; // 2 m long
  for (const auto &[against, held, friction] :
       {std::tuple{disk, pushed, std::string()},
        {level, loaded, std::string(", friction: {coulomb: 0.2}")}}) {
    SCOPED_TRACE(against + held + friction);
    const std::string text = "rbvi: 1\nphysics: plane_strain\n"
                             "mesh: {built_in: half_disc, angle: 45, edges: 8, degree: 1}\n"
                             "parameters: {press: {range: [0.05, 1], default: 0.3}}\n"
                             "materials: {rubber: {at: all, E: 24, nu: 0.3}}\n" +
                             held + "contact: {tyre: {at: contact, against: " + against +
                             ", kinematics: large" + friction + "}}\n";
    Reduced made(make_scene(read_case(text, "tyre.yaml"), {}), "grid:3");
    made.reduce(testing_reduced::everything());
    const HfSolution full = HighFidelity(made.problem, {}).solve({0.4});
    if (rank_of(PETSC_COMM_WORLD) != 0) continue;
    OnlineSolver online(made.model);
    const Outputs outputs = online.outputs({0.4}, online.solve({0.4}));
    EXPECT_NEAR(outputs.reaction.value(), 0.4, 1e-8);
    EXPECT_NEAR(full.outputs.reaction.value(), 0.4, 1e-8);
    EXPECT_NEAR(outputs.energy.value(), full.outputs.energy.value(),
                1e-6 * std::abs(full.outputs.energy.value()));
  }
}

/// Nothing but the load acts, so that all answers are proportional to it.
TEST(FreeBodies, AnswersAreProportionalToTheLoad) {
  const std::string text =
      "rbvi: 1\nphysics: plane_strain\nmesh: {built_in: two_blocks, degree: 1}\n"
      "parameters: {load: {range: [0.1, 1000], default: 1}, c: {range: [0.05, 0.6], default: "
      "0.2}}\n"
      "materials:\n  soft: {at: upper, E: 10, nu: 0.45}\n  hard: {at: lower, E: 20, nu: 0.1}\n"
      "imposed: {bottom: {at: bottom, ux: 0, uy: 0}}\nloads: {top: {at: top, pressure: load}}\n"
      "contact: {seat: {at: slave, against: master, multiplier: p0, friction: {coulomb: c}}}\n";
  Problem problem(PETSC_COMM_WORLD, make_scene(read_case(text, "blocks.yaml"), {}), {});
  HighFidelity solver(problem, {});
  for (const double c : {0.05, 0.2, 0.4, 0.6}) {
    const Vector one = solver.solve({1, c}).lambda;
    EXPECT_GT(one.tail(one.size() / 2).cwiseAbs().maxCoeff(), 1e-3) << "it spreads";
    for (const double load : {0.1, 0.24, 0.7, 1000.0})
      EXPECT_LE((solver.solve({load, c}).lambda / load - one).cwiseAbs().maxCoeff(), 1e-9)
          << load << ' ' << c;
  }
}

} // namespace
} // namespace rbvi::free_bodies_test
