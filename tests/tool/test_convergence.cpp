// Orders and limits of values on refined meshes.
#include "rbvi/tool/convergence.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::convergence_test {
namespace {

TEST(Convergence, OfAPowerOfTheSizeIsExact) {
  for (const double order : {1.0, 1.5, 2.0, 4.0})
    for (const std::vector<int> &refinements : {std::vector{0, 1, 2, 3}, {0, 2, 4}}) {
      std::vector<double> values;
      for (const int refine : refinements)
        values.push_back(7 - 3 * std::exp2(-order * refine));
      const Convergence found = convergence_of(values, refinements);
      ASSERT_EQ(found.orders.size(), refinements.size() - 2);
      for (const std::optional<double> &observed : found.orders)
        EXPECT_NEAR(observed.value(), order, 1e-9);
      EXPECT_NEAR(found.richardson.value(), 7, 1e-12);
    }
}

TEST(Convergence, IsNotToldOfWhatDoesNotConverge) {
  for (const std::vector<double> &values :
       {std::vector<double>{1, 2, 1.5}, {1, 1, 1}, {1, 2, 2}, {1, 2, 4}, {1, 2}, {1, NAN, 2}})
    EXPECT_FALSE(convergence_of(values, {0, 1, 2}).richardson) << values.back();
  EXPECT_FALSE(convergence_of({1, 2, 2.5}, {0, 1, 3}).orders.front()) << "not cut alike";
  EXPECT_NEAR(convergence_of({1, 2, 4}, {0, 1, 2}).orders.front().value(), -1, 1e-12);
}

} // namespace
} // namespace rbvi::convergence_test
