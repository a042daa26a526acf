// Reduced models with the other loads: a temperature, a spring, a total force.
#include "reduced.hpp"

#include "rbvi/model/online.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/scene/case.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <optional>

namespace rbvi::loads_model_test {
namespace {

using testing_reduced::Reduced;

/// A wheel on a bottom that moves sideways, whose hub is lifted, and held sideways by a spring.
TEST(LoadsModel, AnswersAsFullSolvesDo) {
  const std::string text =
      "rbvi: 1\nphysics: plane_strain\nmesh: {built_in: annulus, edges: 16}\n"
      "parameters: {f: {range: [0.5, 3], default: 1}, t: {range: [0.5, 2], default: 1},\n"
      "  k: {range: [1, 50], default: 10}, d: {range: [0, 0.01], default: 0}}\n"
      "materials: {rubber: {at: all, lambda: 12, mu: 6, expansion: 0.01, temperature: t*(1 + x)}}\n"
      "imposed: {bottom: {at: bottom, ux: d, uy: 0}, hub: {at: hub, force_y: f}}\n"
      "springs: {side: {at: hub, stiffness: k, direction: [1, 0]}}\n"
      "contact: {lid: {at: top, against: {plane: {normal: [0, 1], position: 1}}}}\n";
  const Scene scene = make_scene(read_case(text, "case.yaml"), {});
  Reduced wheel(scene, "random:40:1");
  wheel.reduce(testing_reduced::everything());
  HighFidelity solver(wheel.problem, {});
  std::optional<ReducedModel> stored;
  const auto path =
      std::filesystem::temp_directory_path() / ("rbvi_loads_" + std::to_string(getpid()) + ".h5");
  collectively(PETSC_COMM_WORLD, [&] {
    write_model(wheel.model, path);
    stored = read_model(path, {});
    std::filesystem::remove(path);
  });
  OnlineSolver online(*stored);
  ASSERT_TRUE(online.scene().materials.front().free_strain);
  EXPECT_EQ(online.scene().materials.front().free_strain({1, 2, 1, 0}, {0.5, 0, 0}), 0.03);
  const ModelFields &fields = wheel.model.fields;
  for (const Mu &mu : {Mu{0.7, 1.9, 3, 0}, Mu{2.5, 0.6, 40, 0.008}}) {
    const HfSolution s = solver.solve(mu);
    const Outputs found = online.outputs(mu, online.solve(mu));
    EXPECT_GT(s.outputs.normal_force.value(), 0.1);
    EXPECT_NEAR(found.normal_force.value() / *s.outputs.normal_force, 1, 1e-7);
    EXPECT_NEAR(found.energy.value() / *s.outputs.energy, 1, 1e-7);
    EXPECT_NEAR(found.peak_pressure.value() / *s.outputs.peak_pressure, 1, 1e-6);
  }
  const Vector lift = fields.basis.col(0);
  Index first = -1;
  for (Index node = 0; node < fields.points.rows(); ++node) {
    if (std::abs(fields.points.row(node).norm() - 0.3) > 1e-9) continue;
    if (first < 0) first = node;
    EXPECT_EQ(lift[2 * node + 1], lift[2 * first + 1]) << "the hub moves as one";
  }
  EXPECT_GE(first, 0);
}

} // namespace
} // namespace rbvi::loads_model_test
