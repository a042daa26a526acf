#include "rbvi/study/output_errors.hpp"

#include "rbvi/core/error.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace rbvi::output_errors_test {
namespace {

Outputs with_energy(double energy) {
  Outputs outputs;
  outputs.energy = energy;
  outputs.seconds = 1;
  return outputs;
}

TEST(OutputErrors, AreAbsoluteOverTheRangeAndOverTheValue) {
  const std::vector<OutputError> errors =
      output_errors({with_energy(1.1), with_energy(3)}, {with_energy(1), with_energy(3)});
  ASSERT_EQ(errors.size(), 1U); // seconds have no error
  EXPECT_EQ(errors[0].name, "energy");
  EXPECT_NEAR(errors[0].max, 0.1, 1e-15);
  EXPECT_NEAR(errors[0].mean, 0.05, 1e-15);
  EXPECT_NEAR(errors[0].max_of_range, 0.05, 1e-15);
  EXPECT_NEAR(errors[0].max_of_value, 0.1, 1e-15);
}

TEST(OutputErrors, AreNeverRelativeToANumberNearZero) {
  const std::vector<OutputError> errors =
      output_errors({with_energy(1e-3), with_energy(-10)}, {with_energy(0), with_energy(-10)});
  EXPECT_NEAR(errors[0].max_of_value, 1e-2, 1e-15); // over a hundredth of 10
  const std::vector<OutputError> constant =
      output_errors({with_energy(5.001), with_energy(5)}, {with_energy(5), with_energy(5)});
  EXPECT_NEAR(constant[0].max_of_range, 0.001 / 0.05, 1e-12);
  const std::vector<OutputError> zero =
      output_errors({with_energy(0), with_energy(0)}, {with_energy(0), with_energy(0)});
  EXPECT_EQ(zero[0].max_of_range, 0);
}

/// 4 nodes on a length of 0.2, of which 2 stick on 0.1.
TEST(OutputErrors, OfLengthsThatAreCountedAreAStepWherePressuresAreOff) {
  const auto answer = [](double force) {
    Outputs outputs;
    outputs.normal_force = force;
    outputs.contact_nodes = 4;
    outputs.contact_measure = 0.2;
    outputs.stick_half_width = 0.05;
    return outputs;
  };
  const auto error_of = [&](double force, const std::string &name) {
    const std::vector<OutputError> errors = output_errors({answer(force)}, {answer(1)});
    return std::ranges::find(errors, name, &OutputError::name)->max;
  };
  EXPECT_EQ(error_of(1 + 1e-12, "contact_measure"), 0);
  EXPECT_EQ(error_of(1 + 1e-12, "stick_half_width"), 0);
  EXPECT_NEAR(error_of(1 + 1e-4, "contact_measure"), 0.05, 1e-15);
  EXPECT_NEAR(error_of(1 + 1e-4, "stick_half_width"), 0.025, 1e-15);
  EXPECT_NEAR(error_of(1 + 1e-4, "normal_force"), 1e-4, 1e-12);
}

TEST(OutputErrors, LeaveOutQueriesWithoutAnAnswer) {
  const std::vector<OutputError> errors =
      output_errors({Outputs{}, with_energy(2.5)}, {with_energy(1), with_energy(2)});
  EXPECT_EQ(errors[0].max, 0.5);
  EXPECT_EQ(errors[0].mean, 0.5);
  EXPECT_THROW((void)output_errors({Outputs{}}, {}), Error);
}

} // namespace
} // namespace rbvi::output_errors_test
