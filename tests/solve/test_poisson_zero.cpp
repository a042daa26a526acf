// Poisson's ratio 0, and below, where contact alone holds a body: Lame's lambda is zero, or
// negative.
#include "../mesh/temporary_file.hpp"
#include "../ring_mesh.hpp"
#include "rbvi/scene/case.hpp"
#include "rbvi/solve/high_fidelity.hpp"

#include <gtest/gtest.h>

namespace rbvi::poisson_zero_test {
namespace {

/// A section between x = 1 and 2 on a floor, pushed down by `push`, whose sum is f.
Scene pushed(const std::string &physics, const std::string &material, const std::string &push) {
  return make_scene(
      read_case("rbvi: 1\nphysics: " + physics +
                    "\nmesh: {file: ring.msh}\n"
                    "parameters: {f: {range: [0.1, 2], default: 1}, "
                    "nu: {range: [-0.2, 0.3], default: 0}, k: {range: [1, 9], default: 2}}\n"
                    "require: {all: {that: f + nu + k > 0, says: no}}\nmaterials: {b: {at: all, " +
                    material + "}}\n" + push +
                    "\ncontact: {floor: {at: bottom, against: {plane: {normal: [0, -1], position: "
                    "0}}}}\n",
                "case.yaml"),
      {});
}

TEST(PoissonZero, ForcesOfBodiesThatContactHoldsBalance) {
  const TemporaryFile file(ring_mesh({1, 2, 0, 1, 4, 4}));
  for (const std::string material : {"E: 10, nu: 0", "E: 10, nu: nu", "E: 5*k, nu: 0",
                                     "E: 5*k, nu: nu", "lambda: 0, mu: 5", "lambda: nu, mu: k"})
    for (const std::string physics : {"plane_strain", "plane_stress", "axisymmetric"}) {
      const bool turned = physics == "axisymmetric";
      const std::string side = turned ? "" : "side: {at: inner, ux: 0}, ",
                        area = turned ? "3*pi" : "1";
      for (const std::string &push : {"imposed: {" + side + "top: {at: top, force_y: -f}}",
                                     "imposed: {" + (turned ? "o: {at: outer, ux: 0}" : side) +
                                         "}\nloads: {w: {at: top, "
                                         "pressure: f/(" +
                                         area + ")}}"}) {
        SCOPED_TRACE(material + " " + physics + " " + push);
        Problem problem(PETSC_COMM_WORLD, pushed(physics, material, push), {file.name(), 0});
        HighFidelity solver(problem, {});
        for (const double nu : {-0.2, 0.0, 0.3}) {
          const HfSolution s = solver.solve({1.3, nu, 2});
          EXPECT_NEAR(*s.outputs.normal_force, 1.3, 1e-9);
          EXPECT_LE(s.kkt.largest(), residual_limit);
        }
      }
    }
}

/// Only a modulus scales a stiffness whose other term is zero; nothing loads the block.
TEST(PoissonZero, ATermThatVanishesIsNoPartOfTheStiffness) {
  const TemporaryFile file(ring_mesh({1, 2, 0, 1, 4, 4}));
  for (const std::string material : {"E: k, nu: 0", "lambda: 0, mu: k/2"}) {
    Problem problem(PETSC_COMM_WORLD,
                    pushed("plane_strain", material,
                           "imposed: {side: {at: inner, ux: 0}, top: {at: top, uy: -0.01*f}}"),
                    {file.name(), 0});
    HighFidelity solver(problem, {});
    for (const double k : {1.0, 3.0, 9.0})
      EXPECT_NEAR(*solver.solve({1, 0, k}).outputs.normal_force, 0.01 * k, 1e-12);
  }
}

} // namespace
} // namespace rbvi::poisson_zero_test
