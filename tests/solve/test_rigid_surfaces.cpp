// What is rigid is one: planes, disks and level sets that are the same give the same answer with
// all keys of a case, at rest and where the body now is, by multipliers and by Nitsche's method.
#include "rbvi/core/error.hpp"
#include "rbvi/scene/case.hpp"
#include "rbvi/solve/high_fidelity.hpp"

#include <gtest/gtest.h>

namespace rbvi::rigid_surfaces_test {
namespace {

/// A half disk of radius 1 about the origin, pushed down and aside by its flat top onto what is
/// rigid, with friction.
Outputs pressed(const std::string &against, const std::string &keys) {
  const Scene scene =
      make_scene(read_case("rbvi: 1\nphysics: plane_strain\n"
                           "mesh: {built_in: half_disc, angle: 22.5, edges: 24, degree: 2}\n"
                           "parameters: {push: {range: [0, 0.1], default: 0.05}}\n"
                           "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
                           "imposed: {top: {at: top, ux: 0.2*push, uy: -push}}\n"
                           "contact: {foot: {at: contact, friction: {coulomb: 0.3}, against: {" +
                               against + "}, " + keys + "}}\n",
                           "half_disc.yaml"));
  Problem problem(PETSC_COMM_WORLD, scene, {});
  return HighFidelity(problem, {}).solve({0.05}).outputs;
}

void expect_same(const std::string &one, const std::string &other, const std::string &keys,
                 double tolerance) {
  SCOPED_TRACE(one + ", " + keys);
  const Outputs a = pressed(one, keys), b = pressed(other, keys);
  EXPECT_GT(*a.normal_force, 0.1);
  for (const auto member : {&Outputs::energy, &Outputs::normal_force, &Outputs::tangential_force,
                            &Outputs::horizontal_reaction, &Outputs::contact_measure}) {
    const double expected = *(b.*member);
    EXPECT_NEAR(*(a.*member), expected, tolerance * std::abs(expected));
  }
}

/// With all that a case can say.
const std::vector<std::string> all_keys{
    "normal: rigid",
    "normal: rigid, gap: ray, gap_from: edges",
    "normal: rigid, gap: vertical",
    "normal: body",
    "normal: body, gap: ray",
    "normal: body, gap: vertical, lumped: yes",
    "kinematics: large",
    "kinematics: large, gap_from: edges, lumped: yes",
    "kinematics: large, normal: deformed",
    "formulation: nitsche, normal: rigid",
    "formulation: nitsche, normal: body, gap: ray",
    "formulation: nitsche, kinematics: large",
};

/// Of a radius of 1e3 beside that of the body, 1.
TEST(RigidSurfaces, ADiskOfALargeRadiusIsAPlane) {
  for (const std::string &keys : all_keys)
    expect_same("disk: {center: [0, -1.001 - 1e3], radius: 1e3}",
                "plane: {normal: [0, -1], position: 1.001}", keys, 3e-3);
}

TEST(RigidSurfaces, ALevelSetOfAPlaneIsThePlane) {
  for (const std::string &keys : all_keys)
    expect_same("level_set: 0.1*x + y + 1.01",
                "plane: {normal: [0, -1], position: '1.01/hypot(0.1, 1)', tilt: -atan(0.1)}", keys,
                1e-8);
}

TEST(RigidSurfaces, ALevelSetOfADiskIsTheDisk) {
  for (const std::string &keys : all_keys)
    expect_same("level_set: (x - 0.1)^2 + (y + 2.001)^2 - 1",
                "disk: {center: [0.1, -2.001], radius: 1}", keys, 1e-7);
}

/// The condition of a plane is linear in the displacement.
TEST(RigidSurfaces, APlaneIsTheSameWhereverTheBodyIs) {
  const std::string plane = "plane: {normal: [0, -1], position: 1.001, tilt: 0.1}";
  for (const std::string keys : {"", "lumped: yes, ", "gap_from: edges, "}) {
    const Outputs small = pressed(plane, keys + "kinematics: small"),
                  large = pressed(plane, keys + "kinematics: large");
    EXPECT_NEAR(*large.energy, *small.energy, 1e-9 * *small.energy);
    EXPECT_NEAR(*large.tangential_force, *small.tangential_force, 1e-8);
  }
}

TEST(RigidSurfaces, WhatIsNotOfferedIsRefusedForAll) {
  for (const std::string against : {"plane: {normal: [0, -1], position: 1}",
                                    "disk: {center: [0, -2], radius: 1}", "level_set: y + 1"}) {
    EXPECT_THROW(pressed(against, "kinematics: large, gap: ray"), Error);
    EXPECT_THROW(pressed(against, "kinematics: large, normal: body"), Error);
    EXPECT_THROW(pressed(against, "normal: deformed"), Error);
    EXPECT_THROW(pressed(against, "kinematics: large, normal: deformed, formulation: nitsche"),
                 Error);
  }
}

} // namespace
} // namespace rbvi::rigid_surfaces_test
