// Rigid surfaces in space: their distances are right, and their normals the gradients of these. A
// frame that is carried to another normal is a frame there.
#include "../../src/contact/frames.hpp"
#include "../core/refuses.hpp"
#include "rbvi/contact/surfaces.hpp"
#include "rbvi/core/formula.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace rbvi::surfaces_in_space_test {
namespace {

const FullMu mu{0.3};

std::array<std::function<Coefficient>, 3> at(const Point &x) {
  return {constant(x[0]), constant(x[1]), constant(x[2])};
}

/// n is of length 1 and the gradient of the distance, whose level surfaces are 1 apart.
void expect_gradient(const std::function<Surface> &surface, const Point &y) {
  constexpr double step = 1e-6;
  const SurfacePoint here = surface(mu, y);
  EXPECT_NEAR(norm(here.normal), 1, 1e-14);
  for (std::size_t c = 0; c < 3; ++c) {
    Point before = y, after = y;
    before[c] -= step;
    after[c] += step;
    EXPECT_NEAR((surface(mu, after).distance - surface(mu, before).distance) / (2 * step),
                here.normal[c], 1e-8);
  }
  const SurfacePoint foot = surface(mu, y - here.distance * here.normal);
  EXPECT_NEAR(foot.distance, 0, 1e-12);
}

const std::vector<Point> points{{0.7, -0.4, 1.3}, {-1.1, 0.9, 0.8}, {0.2, 1.4, -0.6}};

TEST(SurfacesInSpace, NormalsAreGradientsOfDistances) {
  const Point axis{2.0 / 7, 3.0 / 7, 6.0 / 7};
  for (const Point &y : points) {
    expect_gradient(sphere_surface(at({0.1, 0.2, -0.1}), parameter(0)), y);
    expect_gradient(cylinder_surface(at({0.1, 0.2, -0.1}), axis, parameter(0)), y);
    expect_gradient(plane_surface(axis, {0.1, 0, 0.3}, parameter(0), constant(0.4), {0, 0.6, 0.8}),
                    y);
  }
  const auto cone = cone_surface(at({0, 0, 0}), {0, 0, -1}, constant(0.5));
  for (const Point &y : {Point{0.7, -0.4, -1.3}, Point{0.3, 0.9, -0.1}})
    expect_gradient(cone, y);
  EXPECT_NEAR(cone(mu, {1, 0, 0}).distance, std::cos(0.5), 1e-15);
}

TEST(SurfacesInSpace, KnownDistances) {
  EXPECT_NEAR(sphere_surface(at({1, 2, 3}), constant(2))(mu, {1, 2, 6}).distance, 1, 1e-15);
  const auto tilted =
      plane_surface({0, 0, -1}, {}, constant(1), constant(std::numbers::pi / 2), {1, 0, 0});
  EXPECT_NEAR(tilted(mu, {5, -0.25, 7}).distance, 1.25, 1e-14) << "its normal has become e_y";
}

/// A level set is the surface that it describes, plane or round.
TEST(SurfacesInSpace, ALevelSetIsItsSurface) {
  const auto level = [](const std::string &phi) {
    const Formula formula{{parse_expression(phi)}};
    return level_set(point_value_of(formula), gradient_of(formula));
  };
  const auto sphere = sphere_surface(at({0.1, 0.2, -0.1}), constant(0.5));
  const auto same = level("sqrt((x - 0.1)^2 + (y - 0.2)^2 + (z + 0.1)^2) - 0.5"),
             squared = level("(x - 0.1)^2 + (y - 0.2)^2 + (z + 0.1)^2 - 0.25"),
             slanted = level("3*x + 2*y - 6*z + 7");
  for (const Point &y : {Point{0.5, 0.4, 0.2}, Point{0.1, 0.2, 0.6}, Point{-0.3, 0.1, -0.2}}) {
    const SurfacePoint expected = sphere(mu, y);
    for (const auto &of : {same, squared}) {
      EXPECT_NEAR(of(mu, y).distance, expected.distance, 1e-12);
      EXPECT_NEAR(norm(of(mu, y).normal - expected.normal), 0, 1e-10);
    }
    EXPECT_NEAR(slanted(mu, y).distance, (3 * y[0] + 2 * y[1] - 6 * y[2] + 7) / 7, 1e-14);
  }
  EXPECT_THROW((void)level("x^2 + y^2 + z^2")(mu, {0, 0, 0}), Error);
}

TEST(SurfacesInSpace, RefusesDirectionsThatAreNotOfLengthOne) {
  EXPECT_TRUE(refuses("the axis of a rigid cylinder is (0, 0, 2)", [] {
    (void)cylinder_surface(at({}), {0, 0, 2}, constant(1));
  }));
  EXPECT_THROW((void)sphere_surface(at({}), constant(1))(mu, {0, 0, 0}), Error);
}

TEST(Frames, AreCarriedAsFrames) {
  const Point n{2.0 / 7, 3.0 / 7, 6.0 / 7};
  const Frame frame = frame_of(n);
  for (const Point &to : {Point{0, 0, 1}, Point{0.6, 0, 0.8}, Point{1, 0, 0}, n}) {
    const Point first = carried(frame, 0, to), second = carried(frame, 1, to);
    EXPECT_NEAR(norm(first), 1, 1e-14);
    EXPECT_NEAR(dot(first, to), 0, 1e-14);
    EXPECT_NEAR(dot(second, to), 0, 1e-14);
    EXPECT_NEAR(norm(cross(first, second) - to), 0, 1e-14) << "right-handed";
  }
}

/// Of normals in a plane it is the quarter turn of the normal, at every normal.
TEST(Frames, InThePlaneTangentsAreQuarterTurns) {
  const Frame frame{{0.6, -0.8, 0}, {{{0.8, 0.6, 0}, {0, 0, 1}}}};
  for (const double angle : {-2.0, -1.0, 0.0, 0.5}) {
    const Point n{std::cos(angle), std::sin(angle), 0};
    EXPECT_NEAR(norm(carried(frame, 0, n) - Point{-n[1], n[0], 0}), 0, 1e-14);
    EXPECT_NEAR(norm(carried(frame, 1, n) - Point{0, 0, 1}), 0, 1e-14);
  }
}

} // namespace
} // namespace rbvi::surfaces_in_space_test
