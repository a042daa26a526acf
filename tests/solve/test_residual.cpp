// Answers that round-off does not refuse, and wrong ones that are refused all the same.
#include "../mesh/temporary_file.hpp"
#include "../ring_mesh.hpp"
#include "rbvi/scene/case.hpp"
#include "rbvi/solve/high_fidelity.hpp"
#include "rbvi/solve/methods.hpp"
#include "rbvi/solve/vectors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace rbvi::solve_residual_test {
namespace {

Scene scene_of(const std::string &rest) {
  return make_scene(read_case("rbvi: 1\n" + rest, "case.yaml"), {});
}

/// Clamped at x = 0, of height 1 and E = 210000, over a floor 0.2 below; a load of 1 moves its end
/// down by 0.1 where it does not touch.
Scene cantilever(int length) {
  const std::string l = std::to_string(length);
  return scene_of("physics: plane_strain\nmesh: {file: ring.msh, degree: 2}\n"
                  "parameters: {load: {range: [0, 10], default: 1}}\n"
                  "materials: {b: {at: all, E: 210000, nu: 0}}\n"
                  "imposed: {clamp: {at: inner, ux: 0, uy: 0}}\n"
                  "loads: {load: {at: top, pressure: load*0.1*8*210000/12/" +
                  l + "^4}}\n" +
                  "contact: {floor: {at: bottom, against: {plane: {normal: [0, -1], position: "
                  "0.2}}}}\noutputs: {tip: {value: uy, point: [" +
                  l + ", 1]}}\n");
}

std::string beam_mesh(int length) {
  return ring_mesh({0, double(length), 0, 1, 4 * length, 4});
}

double named(const HfSolution &s, const std::string &name) {
  return output_column(name).of(s.outputs).value();
}

/// -q L^4 / (8 E I) with Timoshenko's share of shear.
TEST(Residual, SlenderCantileversAreAnswered) {
  for (const int length : {10, 20, 50}) {
    const TemporaryFile file(beam_mesh(length));
    Problem problem(PETSC_COMM_WORLD, cantilever(length), {file.name(), 0});
    HighFidelity solver(problem, {});
    const HfSolution s = solver.solve({1});
    EXPECT_LE(s.kkt.largest(), residual_limit);
    EXPECT_NEAR(named(s, "tip"), -0.1 * (1 + 0.8 / length / length), 3e-4 * 0.1) << length;
    const HfSolution on_floor = solver.solve({8});
    EXPECT_LE(on_floor.kkt.largest(), residual_limit);
    EXPECT_GT(*on_floor.outputs.normal_force, 0);
  }
}

/// A millionth of u, of the multipliers, or one node of the active set.
TEST(Residual, WrongAnswersOfASlenderCantileverAreRefused) {
  const TemporaryFile file(beam_mesh(20));
  Problem problem(PETSC_COMM_WORLD, cantilever(20), {file.name(), 0});
  HighFidelity solver(problem, {});
  const HfSolution s = solver.solve({8});
  const Operators &op = problem.assemble({8});
  const Handle<KSP> ksp = make_direct_solver(PETSC_COMM_WORLD, "hf_");
  set_operator(ksp.get(), op.a);
  FactoredBody body(ksp.get(), problem.trace(), ColumnsLast::for_all_mu);
  body.set(op.a);
  const Handle<Vec> u = like(op.f);
  const auto left = [&](const Vector &lambda) {
    return kkt_residual(problem.trace(), op, u.get(), lambda).largest();
  };
  body.displacement(op, s.lambda, u.get());
  EXPECT_LE(s.kkt.largest(), residual_limit);
  const double round_off = left(s.lambda); // of u without refinement
  EXPECT_LE(round_off, 10 * residual_limit);
  EXPECT_GT(left((1 + 1e-6) * s.lambda), 10 * std::max(round_off, residual_limit));
  RBVI_CALL(VecScale(u.get(), 1 + 1e-6));
  EXPECT_GT(left(s.lambda), 10 * std::max(round_off, residual_limit));
  // The answer of these active sets alone.
  const auto of_sets = [&](const std::vector<Index> &active) {
    const Matrix columns = condensed_columns(body, op.b, active);
    const Vector q = op.g - op.b * body.free(op);
    Vector lambda = Vector::Zero(q.size());
    lambda(active) = -Matrix(columns(active, Eigen::all)).lu().solve(Vector(q(active)));
    body.displacement(op, lambda, u.get());
    return left(lambda);
  };
  std::vector<Index> active = s.active;
  EXPECT_LE(of_sets(active), 1e3 * residual_limit) << "without refinement";
  active.pop_back();
  EXPECT_GT(of_sets(active), 1e6 * residual_limit);
  active = s.active;
  active.push_back(active.back() > 0 ? 0 : 1);
  EXPECT_GT(of_sets(active), 1e6 * residual_limit);
}

/// A block that fills its rigid box, hot by t: pressed by E alpha t / (1 - 2 nu), u = 0 and gap 0.
TEST(Residual, AConfinedBlockIsPressed) {
  for (const std::string temperature : {"t", "t*(1 + 1e-3*x)"})
    for (const std::string degree : {"1", "2"}) {
      const Scene scene =
          scene_of("physics: plane_strain\nmesh: {built_in: one_block, degree: " + degree +
                   "}\nparameters: {t: {range: [10, 100], default: 50}}\n"
                   "materials: {b: {at: all, E: 10, nu: 0.3, expansion: 1e-4, temperature: '" +
                   temperature +
                   "'}}\nimposed: {sides: {at: sides, ux: 0}, top: {at: top, uy: 0}}\n"
                   "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], position: "
                   "0}}}}\n");
      Problem problem(PETSC_COMM_WORLD, scene, {});
      const HfSolution s = HighFidelity(problem, {}).solve({50});
      EXPECT_LE(s.kkt.largest(), residual_limit);
      const double pressure = 10 * 5e-3 / 0.4;
      EXPECT_NEAR(*s.outputs.normal_force, pressure, temperature == "t" ? 1e-12 : 2e-3 * pressure);
    }
}

/// Two blocks pressed together at large deformations: what the steps leave of the laws is refined
/// until it is as small as an answer's.
TEST(Residual, StepsAtLargeDeformationsEndWhereTheLawsHold) {
  const Scene scene = scene_of(
      "physics: plane_strain\nmesh: {built_in: two_blocks, degree: 1}\n"
      "parameters: {depth: {range: [0.005, 0.06], default: 0.058}, "
      "shift: {range: [-0.03, 0.05], default: 0}}\n"
      "map: [x, 'y > 0 ? y - 0.25 : y + 0.25']\nmaterials: {rubber: {at: all, E: 20, nu: 0.3}}\n"
      "imposed: {top: {at: top, uy: -depth, ux: shift}, base: {at: bottom, ux: 0, uy: 0}}\n"
      "contact: {faces: {at: slave, against: master, kinematics: large, multiplier: p1}}\n");
  Problem problem(PETSC_COMM_WORLD, scene, {});
  HighFidelity solver(problem, {});
  for (const Mu &mu : {Mu{0.06, 0.05}, Mu{0.03, 0}, Mu{0.06, -0.03}})
    EXPECT_LE(solver.solve(mu).kkt.largest(), 10 * residual_limit);
}

} // namespace
} // namespace rbvi::solve_residual_test
