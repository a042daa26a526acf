// Reduced models of bodies that are turned about x = 0, against full solves.
#include "../mesh/temporary_file.hpp"
#include "../ring_mesh.hpp"
#include "reduced.hpp"

#include "rbvi/model/online.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/scene/case.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>

namespace rbvi::axisymmetric_model_test {
namespace {

using testing_reduced::Reduced;

Scene tube(const std::string &contact) {
  const std::string text =
      "rbvi: 1\nphysics: axisymmetric\nmesh: {file: ring.msh}\n"
      "parameters: {p: {range: [0.2, 1], default: 0.5}, s: {range: [0.5, 2], default: 1},\n"
      "  k: {range: [0.5, 4], default: 1}}\n"
      "map: {scale: s}\n"
      "materials: {a: {at: low, E: k, nu: 0.4}, b: {at: high, E: 2, nu: 0.3}}\n"
      "imposed: {bottom: {at: bottom, ux: 0, uy: 0}}\n"
      "loads: {outer: {at: outer, pressure: p}, top: {at: inner, traction: [0, p*y]}}\n"
      "contact: {lid: {at: top, against: {plane: {normal: [0, 1], position: s}}" +
      contact + "}}\n";
  return make_scene(read_case(text, "case.yaml"), {});
}

void expect_right(const std::string &contact, const std::string &training, double tolerance) {
  SCOPED_TRACE(contact);
  const TemporaryFile file(ring_mesh({1, 2, 0, 1, 6, 6}));
  Reduced tubes(tube(contact), training, PETSC_COMM_WORLD, {file.name(), 0});
  tubes.reduce(testing_reduced::everything());
  for (const Term &term : tubes.problem.scene().a)
    EXPECT_TRUE(term.theta);
  HighFidelity solver(tubes.problem, {});
  std::optional<OnlineSolver> online;
  std::optional<ReducedModel> stored;
  const auto path =
      std::filesystem::temp_directory_path() / ("rbvi_turned_" + std::to_string(getpid()) + ".h5");
  collectively(PETSC_COMM_WORLD, [&] {
    write_model(tubes.model, path);
    stored = read_model(path, {});
    std::filesystem::remove(path);
    online.emplace(*stored);
    EXPECT_TRUE(online->scene().axisymmetric);
  });
  for (const Mu &mu : {Mu{0.3, 1.7, 3}, Mu{0.9, 0.6, 0.7}}) {
    const Outputs wanted = solver.solve(mu).outputs;
    const Outputs found = online->outputs(mu, online->solve(mu));
    EXPECT_GT(wanted.normal_force.value(), 0.1);
    EXPECT_NEAR(found.normal_force.value() / *wanted.normal_force, 1, tolerance);
    EXPECT_NEAR(found.energy.value() / *wanted.energy, 1, tolerance);
    EXPECT_NEAR(found.contact_measure.value() / *wanted.contact_measure, 1, tolerance);
    EXPECT_NEAR(found.peak_pressure.value() / *wanted.peak_pressure, 1, 10 * tolerance);
  }
}

TEST(AxisymmetricModel, AnswersAsFullSolvesDo) {
  expect_right("", "random:30:1", 1e-6);
  expect_right(", friction: {coulomb: 0.2}", "random:30:1", 1e-6);
}

TEST(AxisymmetricModel, ByNitschesMethodToo) {
  expect_right(", formulation: nitsche", "random:30:1", 1e-3);
}

} // namespace
} // namespace rbvi::axisymmetric_model_test
