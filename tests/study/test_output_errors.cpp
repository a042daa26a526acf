#include "rbvi/study/output_errors.hpp"

#include "rbvi/core/error.hpp"

#include <gtest/gtest.h>

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

TEST(OutputErrors, LeaveOutQueriesWithoutAnAnswer) {
  const std::vector<OutputError> errors =
      output_errors({Outputs{}, with_energy(2.5)}, {with_energy(1), with_energy(2)});
  EXPECT_EQ(errors[0].max, 0.5);
  EXPECT_EQ(errors[0].mean, 0.5);
  EXPECT_THROW((void)output_errors({Outputs{}}, {}), Error);
}

} // namespace
} // namespace rbvi::output_errors_test
