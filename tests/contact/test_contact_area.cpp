// The area in contact of a nodal pressure.
#include "rbvi/contact/contact_area.hpp"

#include <gtest/gtest.h>

namespace rbvi::contact_area_test {
namespace {

/// A strip of squares cut in two: nodes 2 i and 2 i + 1 at x = i, i = 0 .. 4.
const std::vector<int> strip{0, 2, 3, 0, 3, 1, 2, 4, 5, 2, 5, 3,
                             4, 6, 7, 4, 7, 5, 6, 8, 9, 6, 9, 7};

Vector weights() {
  Vector sum = Vector::Zero(10);
  for (const int node : strip)
    sum[node] += 1.0 / 6;
  return sum;
}

TEST(ContactArea, IsTheWholeUnderAConstantPressure) {
  EXPECT_NEAR(contact_area(weights(), Vector::Constant(10, 7.0), strip, 3), 4, 1e-14);
}

TEST(ContactArea, OfNothingIsZero) {
  EXPECT_EQ(contact_area(weights(), Vector::Zero(10), strip, 3), 0);
}

/// Nodes along the edge of contact with a third of the pressure have a third of their patch in it.
TEST(ContactArea, CountsTheEdgeByItsPressure) {
  Vector lambda = Vector::Zero(10);
  lambda.head(4).setConstant(6.0);
  lambda.segment(4, 2).setConstant(2.0);
  const Vector w = weights();
  EXPECT_NEAR(contact_area(w, lambda, strip, 3), w.head(4).sum() + w.segment(4, 2).sum() / 3,
              1e-14);
}

/// It is a measure of where there is pressure, not of how much.
TEST(ContactArea, DoesNotDependOnTheScale) {
  const Vector lambda = Vector::LinSpaced(10, 0, 1), w = weights();
  const double area = contact_area(w, lambda, strip, 3);
  EXPECT_NEAR(contact_area(w, 1e6 * lambda, strip, 3), area, 1e-13);
  EXPECT_LT(area, w.sum());
}

} // namespace
} // namespace rbvi::contact_area_test
