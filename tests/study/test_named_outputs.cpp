// Outputs of a case's own: against closed forms, full and reduced, and back from files.
#include "reduced.hpp"

#include "rbvi/model/online.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/scene/case.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include <unistd.h>

namespace rbvi::named_outputs_test {
namespace {

using testing_reduced::Reduced;

/// A block with a constant pressure p on its foot, 0 <= x <= 1, that carries the shear stress t.
Scene block(const std::string &outputs) {
  const std::string text =
      "rbvi: 1\nphysics: plane_strain\nmesh: {built_in: one_block, degree: 2}\n"
      "parameters: {p: {range: [0.5, 2], default: 1}, t: {range: [0, 0.2], default: 0.1}, "
      "level: {range: [0.1, 0.9], default: 0.3}}\n"
      "materials: {rubber: {at: all, E: 15, nu: 0.3}}\n"
      "loads:\n  top: {at: top, traction: [t, -p]}\n"
      "  sides: {at: sides, traction: ['-p * 0.3 / 0.7 * nx', 't * nx']}\n"
      "contact: {floor: {at: contact, against: {plane: {normal: [0, -1], position: 0}}, "
      "friction: {coulomb: 0.5}}}\noutputs:\n" +
      outputs;
  return make_scene(read_case(text, "block.yaml"), {});
}

const std::string all_kinds = "  force: {integral: pressure, at: floor}\n"
                              "  moment: {integral: pressure * x}\n"
                              "  left: {measure: 'pressure > p/2 and x < level'}\n"
                              "  ramp: {measure: 'pressure * x > level * p'}\n"
                              "  middle: {mean: x, where: x > level}\n"
                              "  first: {min: x, where: x >= level}\n"
                              "  shear: {max: abs(tangential)}\n"
                              "  sunk: {min: uy}\n"
                              "  open: {max: gap}\n";

std::map<std::string, double> values_of(const Outputs &outputs) {
  std::map<std::string, double> values;
  for (const auto &[name, value] : outputs.named)
    values[name] = value;
  return values;
}

void expect_exact(const Mu &mu, const Outputs &outputs) {
  const double p = mu[0], t = mu[1], level = mu[2], near = 1e-9;
  std::map<std::string, double> found = values_of(outputs);
  ASSERT_EQ(found.size(), 9U);
  EXPECT_NEAR(found["force"], p, near);
  EXPECT_NEAR(found["moment"], p / 2, near);
  EXPECT_NEAR(found["left"], level, near) << "ends inside an edge";
  EXPECT_NEAR(found["ramp"], 1 - level, near);
  EXPECT_NEAR(found["middle"], (1 + level) / 2, near);
  EXPECT_NEAR(found["first"], level, near);
  EXPECT_NEAR(found["shear"], t, near);
  EXPECT_NEAR(found["sunk"], 0, near);
  EXPECT_NEAR(found["open"], 0, near);
}

TEST(NamedOutputs, OfAConstantPressureAreExact) {
  Problem problem(PETSC_COMM_WORLD, block(all_kinds), {});
  HighFidelity solver(problem, {});
  for (const Mu &mu : {Mu{1, 0.1, 0.3}, Mu{1.7, 0.05, 0.71}})
    expect_exact(mu, solver.solve(mu).outputs);
}

TEST(NamedOutputs, OfAModelComeBackFromItsFile) {
  Reduced made(block(all_kinds), "grid:2,2,2");
  made.reduce(testing_reduced::everything());
  if (rank_of(PETSC_COMM_WORLD) != 0) return;
  const auto path = std::filesystem::path(testing::TempDir()) /
                    ("rbvi_outputs_" + std::to_string(::getpid()) + ".h5");
  write_model(made.model, path);
  const ReducedModel model = read_model(path, catalogue(), false);
  std::filesystem::remove(path);
  std::filesystem::remove(fields_file(path));
  OnlineSolver online(model);
  for (const Mu &mu : {Mu{0.9, 0.15, 0.45}, Mu{1.9, 0.01, 0.2}})
    expect_exact(mu, online.outputs(mu, online.solve(mu)));
}

/// A measure that did not end inside an edge would jump.
TEST(NamedOutputs, AMeasureIsContinuous) {
  Problem problem(PETSC_COMM_WORLD, block("  left: {measure: pressure * x < level}\n"), {});
  HighFidelity solver(problem, {});
  for (double level = 0.2; level < 0.8; level += 0.013)
    EXPECT_NEAR(values_of(solver.solve({1, 0.1, level}).outputs)["left"], level, 1e-9);
}

TEST(NamedOutputs, OverNothingHaveNoValue) {
  Problem problem(PETSC_COMM_WORLD, block("  none: {mean: pressure, where: x > 1 + level}\n"), {});
  try {
    HighFidelity(problem, {}).solve({1, 0.1, 0.3});
    FAIL() << "a mean over nothing has a value";
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find("the output 'none' has no value"), std::string::npos);
  }
}

} // namespace
} // namespace rbvi::named_outputs_test
