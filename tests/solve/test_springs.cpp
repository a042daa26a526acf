// Springs on boundaries, against bars in series: blocks of the modulus M that their sides hold.
#include "../core/refuses.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/scene/case.hpp"
#include "rbvi/solve/high_fidelity.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::springs_test {
namespace {

double modulus() {
  const auto [lambda, shear] = lame(15, 0.35);
  return lambda + 2 * shear;
}

Scene scene_of(const std::string &mesh, const std::string &rest) {
  return make_scene(
      read_case("rbvi: 1\nphysics: plane_strain\nmesh: {built_in: " + mesh +
                    "}\nparameters: {k: {range: [1, 100], default: 10}, "
                    "f: {range: [0.1, 1], default: 0.5}, q: {range: [0, 0.2], default: 0.1}}\n"
                    "require: {all: {that: k + f + q > 0, says: no}}\n"
                    "materials: {rubber: {at: all, E: 15, nu: 0.35}}\n" +
                    rest,
                "case.yaml"),
      {});
}

/// Two blocks, 1 high together, that a bolt from top to bottom holds together and q pulls apart.
Scene joint(const std::string &bolt, const std::string &held = ", bottom: {at: bottom, uy: 0}") {
  return scene_of("two_blocks", "map: [x, 'y > 0 ? y - 0.25 : y + 0.25']\n"
                                "imposed: {sides: {at: sides, ux: 0}" +
                                    held +
                                    "}\n"
                                    "loads: {lift: {at: top, traction: [0, q]}}\n"
                                    "springs: {bolt: {between: [top, bottom], " +
                                    bolt +
                                    "}}\n"
                                    "contact: {faces: {at: slave, against: master}}\n");
}

double force_of(MPI_Comm comm, const Scene &scene, const Mu &mu, double residual = 1e-11) {
  Problem problem(comm, scene, {});
  const HfSolution s = HighFidelity(problem, {}).solve(mu);
  EXPECT_LE(s.kkt.largest(), residual);
  return s.outputs.normal_force.value();
}

TEST(Springs, ABoltSharesALoadWithItsJoint) {
  const double k = 20, f = 0.6, q = 0.15, ratio = k / modulus();
  const auto force = [&](const std::string &bolt, double lift) {
    return force_of(PETSC_COMM_WORLD, joint(bolt), {k, f, lift});
  };
  // The force at rest is what the pretension leaves when the joint gives way.
  EXPECT_NEAR(force("stiffness: k, pretension: f", 0), f / (1 + ratio), 1e-12);
  // Where it has settled the pretension is the force itself, to round-off.
  const std::string settled = "stiffness: k, pretension: f, settled: '-f/(15*0.65/(1.35*0.3))'";
  EXPECT_NEAR(force(settled, 0), f, 1e-12);
  EXPECT_NEAR(force(settled, q), f - q / (1 + ratio), 1e-12);
}

/// Without a stiffness it is a pair of forces, with a soft spring that holds the body.
TEST(Springs, APretensionAloneIsTheForce) {
  const Scene scene =
      scene_of("two_blocks", "map: [x, 'y > 0 ? y - 0.25 : y + 0.25']\n"
                             "imposed: {sides: {at: sides, ux: 0}, bottom: {at: bottom, uy: 0}}\n"
                             "springs: {bolt: {between: [top, bottom], pretension: f*q},\n"
                             "          hold: {at: slave, stiffness: k}}\n"
                             "contact: {faces: {at: slave, against: master}}\n");
  // Below the hold is half of the joint: force = f q - k u, u = -force / (2 M).
  const double k = 2, force = force_of(PETSC_COMM_WORLD, scene, {k, 0.8, 0.2});
  EXPECT_NEAR(force, 0.16 / (1 + k / (2 * modulus())), 1e-12);
}

/// A floor that rises by 0.02 under a block of height 1/2 below a spring.
TEST(Springs, ToTheGroundIsInSeriesWithABlock) {
  const Scene scene = scene_of(
      "one_block", "imposed: {sides: {at: sides, ux: 0}}\n"
                   "springs: {lid: {at: top, stiffness: k, direction: [0, -1]}}\n"
                   "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], position: "
                   "-0.02}}}}\n");
  for (const double k : {1.0, 30.0})
    EXPECT_NEAR(force_of(PETSC_COMM_WORLD, scene, {k, 1, 0}), 0.02 / (0.5 / modulus() + 1 / k),
                1e-12);
}

TEST(Springs, AreTheSameOnAnyNumberOfRanks) {
  const Scene scene = joint("stiffness: k, pretension: f, direction: [0.6, 0.8]");
  EXPECT_NEAR(force_of(PETSC_COMM_SELF, scene, {7, 0.5, 0.1}),
              force_of(PETSC_COMM_WORLD, scene, {7, 0.5, 0.1}), 1e-12);
}

/// A pair of forces holds nothing: contact alone does, and balances them. The residual loses the
/// digits that the soft springs of a free body cost.
TEST(Springs, ADeadPairOfForcesIsCarriedByContact) {
  EXPECT_NEAR(force_of(PETSC_COMM_WORLD, joint("pretension: f"), {1, 0.8, 0.2}, 3e-11), 0.6, 1e-11);
}

TEST(Springs, WhatTheyDoNotHoldIsRefused) {
  const auto make = [](const Scene &scene) { Problem problem(PETSC_COMM_WORLD, scene, {}); };
  EXPECT_TRUE(refuses("can move along (0, 1)", [&] { make(joint("stiffness: k", "")); }));
  EXPECT_TRUE(refuses("meets a boundary that moves",
                      [&] { make(joint("stiffness: k", ", bottom: {at: bottom, uy: q}")); }));
  EXPECT_TRUE(refuses("stretches the spring", [&] {
    make(scene_of("one_block", "motion: [0, -q]\nimposed: {s: {at: sides, ux: 0, uy: motion}}\n"
                               "springs: {s: {at: top, stiffness: k}}\n"
                               "contact: {f: {at: contact, against: {plane: {normal: [0, -1], "
                               "position: 0}}}}\n"));
  }));
}

} // namespace
} // namespace rbvi::springs_test
