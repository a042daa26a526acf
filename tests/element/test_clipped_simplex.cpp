// The part of a simplex on which a condition holds.
#include "rbvi/element/clipped_simplex.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rbvi::clipped_simplex_test {
namespace {

double measure(const std::vector<Piece> &pieces) {
  double sum = 0;
  for (const Piece &piece : pieces)
    sum += piece.share();
  return sum;
}

/// Of a corner that a cut parallel to the opposite side leaves: c^dim, for each corner.
TEST(ClippedSimplex, IsExactForStraightCuts) {
  for (const int dim : {2, 3})
    for (int corner = 0; corner <= dim; ++corner)
      for (const double c : {0.25, 0.4, 0.77}) {
        const auto at = static_cast<std::size_t>(corner);
        const auto near = [&](const Barycentric &b) { return b[at] > 1 - c; };
        const auto far = [&](const Barycentric &b) { return b[at] <= 1 - c; };
        EXPECT_NEAR(measure(pieces_where(dim, near)), std::pow(c, dim), 1e-12) << dim << corner;
        EXPECT_NEAR(measure(pieces_where(dim, far)), 1 - std::pow(c, dim), 1e-12);
      }
}

/// Two cuts askew: b_1 > b_2 + s, exact by the area of a smaller triangle.
TEST(ClippedSimplex, IsExactForCutsAskew) {
  for (const double s : {-0.3, 0.0, 0.21, 0.5}) {
    const auto holds = [&](const Barycentric &b) { return b[1] > b[2] + s; };
    const double far = (1 - std::abs(s)) * (1 - std::abs(s)) / 2;
    EXPECT_NEAR(measure(pieces_where(2, holds)), s < 0 ? 1 - far : far, 1e-12) << s;
  }
}

/// Curved cuts: a sector of a disk, an octant of a ball. Chords s of a radius r lack (s / r)^2 / 4
/// of a disk and 3/8 of that of a ball; s is an eighth, of tetrahedra with edges of 0.35 most.
TEST(ClippedSimplex, IsCloseForCurvedCuts) {
  for (const int dim : {2, 3}) {
    const double radius = 0.5; // in the coordinates b_1, b_2, ... about corner 0
    const auto holds = [&](const Barycentric &b) {
      return b[1] * b[1] + b[2] * b[2] + b[3] * b[3] < radius * radius;
    };
    const std::vector<Piece> pieces = pieces_where(dim, holds);
    const double exact = dim == 2 ? std::numbers::pi * radius * radius / 4 * 2
                                  : std::numbers::pi * radius * radius * radius / 6 * 6;
    EXPECT_NEAR(measure(pieces), exact, (dim == 2 ? 0.01 : 0.2) * exact);
    for (const Piece &piece : pieces)
      EXPECT_TRUE(holds(piece.at({0.25, 0.25, dim == 2 ? 0.5 : 0.25, dim == 2 ? 0 : 0.25})));
  }
  EXPECT_EQ(pieces_where(2, [](const Barycentric &) { return false; }).size(), 0U);
  EXPECT_NEAR(measure(pieces_where(3, [](const Barycentric &) { return true; })), 1, 1e-13);
}

} // namespace
} // namespace rbvi::clipped_simplex_test
