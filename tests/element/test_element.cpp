// Quadrature, simplex geometry and maps: against closed forms.
#include "rbvi/core/error.hpp"
#include "rbvi/element/geometry.hpp"
#include "rbvi/element/quadrature.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::element_test {
namespace {

double factorial(int n) {
  return n <= 1 ? 1.0 : n * factorial(n - 1);
}

// int of prod b_i^k_i over a simplex, over its volume: dim! prod k_i! / (dim + sum k_i)!
double exact_moment(int dim, const std::array<int, 4> &k) {
  double value = factorial(dim);
  int sum = dim;
  for (int i = 0; i <= dim; ++i) {
    value *= factorial(k[i]);
    sum += k[i];
  }
  return value / factorial(sum);
}

TEST(Quadrature, IntegratesEveryMonomialUpToItsDegree) {
  for (int dim = 1; dim <= 3; ++dim)
    for (int degree : {1, 3, 5, 7})
      for (int i = 0; i <= degree; ++i)
        for (int j = 0; i + j <= degree; ++j) {
          const std::array<int, 4> k{i, j, 0, 0};
          double sum = 0;
          for (const auto &q : simplex_quadrature(dim, degree))
            sum += q.weight * std::pow(q.barycentric[0], i) * std::pow(q.barycentric[1], j);
          EXPECT_NEAR(sum, exact_moment(dim, k), 1e-13) << dim << " " << degree;
        }
}

const std::array<Point, 4> tetrahedron{Point{0.1, 0, 0}, Point{2, 0.3, 0}, Point{0, 1, 0.2},
                                       Point{0.3, 0.1, 1.5}};
const std::array<Point, 4> triangle{Point{0.1, 0, 0}, Point{2, 0.3, 0}, Point{0, 1, 0}, Point{}};

TEST(Simplex, GradientsAreDualToTheVertices) {
  for (int dim : {2, 3}) {
    const auto &x = dim == 2 ? triangle : tetrahedron;
    const Simplex s = simplex(dim, x);
    for (std::size_t i = 0; i <= static_cast<std::size_t>(dim); ++i)
      for (std::size_t j = 0; j <= static_cast<std::size_t>(dim); ++j) {
        double value = 0; // gradient of b_i along the edge from vertex 0 to vertex j
        for (std::size_t c = 0; c < 3; ++c)
          value += s.gradients(static_cast<Index>(i), static_cast<Index>(c)) * (x[j][c] - x[0][c]);
        EXPECT_NEAR(value, (i == j ? 1.0 : 0.0) - (i == 0 ? 1.0 : 0.0), 1e-14);
      }
  }
}

TEST(Simplex, VolumeIsSigned) {
  EXPECT_NEAR(simplex(2, {Point{0, 0, 0}, Point{1, 0, 0}, Point{0, 1, 0}, Point{}}).volume, 0.5,
              1e-15);
  EXPECT_NEAR(simplex(2, {Point{0, 0, 0}, Point{0, 1, 0}, Point{1, 0, 0}, Point{}}).volume, -0.5,
              1e-15);
}

TEST(AspectRatio, IsOneForRegularSimplices) {
  const double h = std::sqrt(3.0) / 2;
  EXPECT_NEAR(aspect_ratio(2, {Point{0, 0, 0}, Point{1, 0, 0}, Point{0.5, h, 0}, Point{}}), 1,
              1e-14);
  EXPECT_NEAR(
      aspect_ratio(3, {Point{1, 1, 1}, Point{1, -1, -1}, Point{-1, 1, -1}, Point{-1, -1, 1}}), 1,
      1e-14);
  EXPECT_GT(aspect_ratio(2, {Point{0, 0, 0}, Point{1, 0, 0}, Point{0.5, 0.1, 0}, Point{}}), 3);
}

TEST(MembraneScene, MapsMoveTheDiscAndLeaveTheBoundary) {
  const FullMu mu{0.24, 0.05, -0.05};
  for (const char *kind : {"similarity", "graded"}) {
    const Scene scene = make_scene("membrane_obstacle", {{"disc_map", kind}});
    for (double angle = 0; angle < 6.3; angle += 0.1) {
      const Point y = scene.map(mu, {0.2 * std::cos(angle), 0.2 * std::sin(angle), 0});
      EXPECT_NEAR(std::hypot(y[0] - mu[1], y[1] - mu[2]), mu[0], 1e-12);
    }
    const Point corner = scene.map(mu, {0.5, -0.5, 0}), side = scene.map(mu, {0.5, 0.1, 0});
    EXPECT_EQ(corner, (Point{0.5, -0.5, 0}));
    EXPECT_EQ(side, (Point{0.5, 0.1, 0}));
  }
}

TEST(MembraneScene, RefusesUnknownNames) {
  EXPECT_THROW(make_scene("membrane"), Error);
  EXPECT_THROW(make_scene("membrane_obstacle", {{"loda", "1"}}), Error);
  EXPECT_THROW(make_scene("membrane_obstacle", {{"load", "heavy"}}), Error);
  EXPECT_THROW(make_scene("membrane_obstacle", {{"disc_map", "conformal"}}), Error);
  try {
    make_scene("membrane");
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find("membrane_obstacle"), std::string::npos);
  }
}

TEST(MapCell, RefusesAnInvertedCell) {
  Scene scene = make_scene("membrane_obstacle");
  scene.map = [](const FullMu &, const Point &x) { return Point{-x[0], x[1], 0}; };
  Cell cell{2, {Point{0, 0, 0}, Point{1, 0, 0}, Point{0, 1, 0}, Point{}}, {}};
  EXPECT_THROW(map_cell(scene, {0.2, 0, 0}, cell), Error);
}

/// int x^i y^j over the unit triangle is i! j! / (i + j + 2)!.
TEST(Element, RadonsRuleIsExactToDegreeFive) {
  for (int i = 0; i <= 5; ++i)
    for (int j = 0; i + j <= 5; ++j) {
      double sum = 0;
      for (const QuadraturePoint &at : radon_quadrature()) {
        EXPECT_GT(at.weight, 0);
        EXPECT_GT(std::min({at.barycentric[0], at.barycentric[1], at.barycentric[2]}), 0);
        sum += at.weight / 2 * std::pow(at.barycentric[1], i) * std::pow(at.barycentric[2], j);
      }
      EXPECT_NEAR(sum, factorial(i) * factorial(j) / factorial(i + j + 2), 1e-15);
    }
}

} // namespace
} // namespace rbvi::element_test
