// The area in contact of a nodal pressure; where contact ends inside an edge, and integrals of
// magnitudes.
#include "rbvi/contact/contact_area.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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

/// Pressures of nodes at -apart and 0 that carry force and moment of the root of the way to t.
NodesBeside root(double t, double apart, double edge) {
  const double way = apart + t, force = 2.0 / 3 * std::pow(way, 1.5), moment = 0.4 * way * force;
  // F = a p0 + b p1, M = c p0 + d p1 of hats, the second of which falls to zero over the edge
  const double a = apart / 2, b = (apart + edge) / 2, c = apart * apart / 6,
               d = apart * apart / 3 + edge * (apart / 2 + edge / 6), of = a * d - b * c;
  return {{(a * moment - c * force) / of, (d * force - b * moment) / of}, apart};
}

NodesBeside gaps(double t, double edge, double apart) {
  const auto gap = [&](double x) { return 3 * std::pow(x - t, 1.5); };
  return {{gap(edge), gap(edge + apart)}, apart};
}

TEST(WayIntoEdge, IsExactForARootAndItsGap) {
  for (const double edge : {0.1, 0.17})
    for (const double apart : {0.1, 0.2})
      for (const double share : {0.05, 0.3, 0.7, 0.99}) {
        const double t = share * edge, none = std::numeric_limits<double>::quiet_NaN();
        const NodesBeside inside = root(t, apart, edge), outside = gaps(t, edge, apart);
        EXPECT_NEAR(way_into_edge(inside, outside, edge), t, 1e-12);
        EXPECT_NEAR(way_into_edge(inside, {{outside.values[0], none}, none}, edge), t, 1e-12)
            << "the boundary ends there";
        EXPECT_NEAR(way_into_edge({{1, none}, none}, outside, edge), t, 1e-12)
            << "one node in contact";
        EXPECT_NEAR(way_to_zone(outside), edge - t, 1e-12);
      }
}

TEST(WayIntoEdge, StaysInTheEdge) {
  EXPECT_EQ(way_into_edge({{5, 1}, 0.1}, {{0, 1}, 0.1}, 0.1), 0.1);
  EXPECT_EQ(way_into_edge({{1e-9, 1}, 0.1}, {{1, 1.01}, 0.1}, 0.1), 0.0);
}

TEST(IntegralOfMagnitude, IsExactWhereTheSignChanges) {
  const auto simpson = [](const auto &f, double from, double to) {
    return (to - from) / 6 * (f(from) + 4 * f((from + to) / 2) + f(to));
  };
  for (const double u : {0.5, 2.0}) // the weight falls from 1 to u
    for (const double v : {-3.0, -0.2, 0.0, 0.7}) {
      const auto of = [&](double s) { return (1 - s + s * u) * (1 - s + s * v); };
      const std::array<double, 2> hats{1.0 / 3 + u / 6, 1.0 / 6 + u / 3};
      const double zero = v < 0 ? 1 / (1 - v) : 1;
      const double exact = simpson(of, 0, zero) + std::abs(simpson(of, zero, 1));
      EXPECT_NEAR(integral_of_magnitude(hats, {1, v}), exact, 1e-14);
      EXPECT_NEAR(integral_of_magnitude(hats, {-1, -v}), exact, 1e-14);
    }
}

} // namespace
} // namespace rbvi::contact_area_test
