// Nitsche's terms on a rigid surface where the body now is: what turns with the displacement, and
// what does not.
#include "../element/cells.hpp"
#include "rbvi/contact/nitsche_support.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "support_scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::nitsche_surface_test {
namespace {

/// A disk of radius 1 below the origin.
SurfacePoint disk_at(const FullMu &, const Point &y) {
  const double x = y[0] - 0.1, z = y[1] + 1.2, r = std::hypot(x, z);
  return {r - 1, {x / r, z / r, 0}, 1 / r};
}

/// The half-plane y <= -0.3.
SurfacePoint plane_at(const FullMu &, const Point &y) {
  return {y[1] + 0.3, {0, 1, 0}, 0};
}

SupportScene scene_of(int degree) {
  SupportScene scene = support_scene(degree);
  scene.motion = [](const FullMu &, const Point &) { return Point{0.02, -0.1, 0}; };
  return scene;
}

struct OnOneCell {
  Cell cell{2, {{{-0.4, 0, 0}, {0.5, 0.1, 0}, {0.1, 0.9, 0}, {}}}, {}};
  Lame material = lame(15, 0.3);
  NitschePoint::Row u = NitschePoint::Row::Random() * 0.1;
  OnOneCell() { cell.mapped = cell.reference; }
};

Facing faced(Surface *surface) {
  return rigid_contact(RigidSurface{.boundary = "support", .surface = surface, .large = true})
      .facing;
}

/// Edge 0 of the cell.
std::array<NitschePoint, 4> points_of(const Scene &scene, const Facing &facing,
                                      const OnOneCell &on) {
  return nitsche_points(scene, facing, {1.0},
                        {on.cell, 0, on.material, simplex(2, on.cell.mapped)});
}

TEST(NitscheSurface, TurnsToTheNormalOfTheSurfaceWhereTheBodyIs) {
  for (const int degree : {1, 2}) {
    const SupportScene scene = scene_of(degree);
    OnOneCell on;
    if (degree == 1) on.u.tail<6>().setZero();
    const Facing facing = faced(disk_at);
    for (NitschePoint point : points_of(scene, facing, on)) {
      const NitschePoint rest = point;
      turn_to(facing, {1.0}, on.u, point);
      Point y = point.place.x; // where the point is
      const Point n0 = rest.facing.normal;
      for (std::size_t c = 0; c < 2; ++c)
        y[c] += scene.motion({1.0}, point.place.x)[c] + rest.n.dot(on.u) * n0[c] +
                rest.tau.dot(on.u) * turned(n0)[c];
      const SurfacePoint below = disk_at({1.0}, y);
      EXPECT_NEAR(point.facing.normal[0], -below.normal[0], 1e-14);
      EXPECT_NEAR(point.facing.normal[1], -below.normal[1], 1e-14);
      EXPECT_NEAR(point.n.dot(on.u) - point.facing.gap, -below.distance, 1e-14);
      EXPECT_NEAR(point.turning, std::min(0.0, point.sigma_n.dot(on.u)) * below.curvature, 1e-13);
      // A stress and a displacement stay what they are.
      EXPECT_NEAR(std::hypot(point.sigma_n.dot(on.u), point.sigma_tau.dot(on.u)),
                  std::hypot(rest.sigma_n.dot(on.u), rest.sigma_tau.dot(on.u)), 1e-13);
      EXPECT_NEAR(std::hypot(point.n.dot(on.u), point.tau.dot(on.u)),
                  std::hypot(rest.n.dot(on.u), rest.tau.dot(on.u)), 1e-14);
      turn_to(facing, {1.0}, NitschePoint::Row::Zero(), point);
      EXPECT_LE((point.sigma_n - rest.sigma_n).norm(), 1e-13 * rest.sigma_n.norm());
      EXPECT_LE((point.tau - rest.tau).norm(), 1e-13);
    }
  }
}

/// u . tau(y) = |x - c| sin(angle between x and y as c sees them, clockwise from the top).
TEST(NitscheSurface, TheSlipIsMeasuredAlongTheTangentOfTheSurface) {
  const SupportScene scene = scene_of(2);
  const OnOneCell on;
  const Facing facing = faced(disk_at);
  for (NitschePoint point : points_of(scene, facing, on)) {
    turn_to(facing, {1.0}, on.u, point);
    const Point &n = point.facing.normal;
    const double from_x = point.place.x[0] - 0.1, from_y = point.place.x[1] + 1.2;
    const double of_reference = std::atan2(from_x, from_y), of_now = std::atan2(-n[0], -n[1]);
    EXPECT_NEAR(point.tau.dot(on.u) + point.facing.slip,
                std::hypot(from_x, from_y) * std::sin(of_now - of_reference), 1e-13);
  }
}

/// A plane has one normal: nothing turns, and contact is that of a support at rest. The stress is
/// the one on the edge.
TEST(NitscheSurface, APlaneIsASupport) {
  const SupportScene scene = scene_of(2);
  const OnOneCell on;
  const Facing plane = faced(plane_at);
  Support support = scene.support;
  support.gap = [](const FullMu &, const Point &x) { return x[1] + 0.3; };
  const auto at_rest = points_of(scene, rigid_contact(support).facing, on);
  auto points = points_of(scene, plane, on);
  for (std::size_t q = 0; q < points.size(); ++q) {
    turn_to(plane, {1.0}, on.u, points[q]);
    EXPECT_LE((points[q].n - at_rest[q].n).norm(), 1e-14);
    EXPECT_LE((points[q].sigma_n - at_rest[q].sigma_n).norm(), 1e-14 * points[q].sigma_n.norm());
    EXPECT_LE((points[q].sigma_tau - at_rest[q].sigma_tau).norm(),
              1e-14 * points[q].sigma_tau.norm());
    EXPECT_NEAR(points[q].facing.gap, at_rest[q].facing.gap, 1e-14);
    EXPECT_NEAR(points[q].facing.slip, at_rest[q].facing.slip, 1e-14);
    EXPECT_EQ(points[q].turning, 0);
  }
  const double x = 0.1, y = -0.9, length = std::hypot(x, y); // outwards from edge 0
  NitschePoint::Row shift = NitschePoint::Row::Zero(); // u = (y, 0): sigma = shear (e_xy + ..)
  const auto nodes = nodes_of(2, 2, on.cell.mapped);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    shift[2 * static_cast<Index>(i)] = nodes[i][1];
  EXPECT_NEAR(points[0].sigma_n.dot(shift), -on.material.shear * x / length, 1e-12);
  EXPECT_NEAR(points[0].sigma_tau.dot(shift), on.material.shear * y / length, 1e-12);
}

/// The terms with the axes held are those of a convex energy; d^T (tangent) d has what the axes
/// turn by.
TEST(NitscheSurface, TheTangentHasWhatTheAxesTurnBy) {
  SupportScene scene = scene_of(2);
  const OnOneCell on;
  scene.materials = {{{}, [&](const FullMu &, const Point &) { return on.material; }}};
  const NitscheLayer layer{scene, {{{}, faced(disk_at), 1}}, {}};
  CurveCell beside{on.cell, 0, {}};
  for (int i = 0; i < 12; ++i)
    beside.dofs[i] = i;
  const Vector u = on.u, d = Vector::Random(12);
  const auto faces = nitsche_faces(layer, {1.0}, {beside}, u);
  Matrix pressures = Matrix::Constant(4, 2, -1.0); // in contact
  pressures(2, 0) = 1;
  auto held = faces;
  for (NitschePoint &point : held[0].points)
    point.turning = 0;
  const auto of_turning = [&](const Matrix &at) {
    return d.dot(nitsche_tangent(faces, at, {})[0] * d) -
           d.dot(nitsche_tangent(held, at, {})[0] * d);
  };
  double turning = 0;
  for (const std::size_t q : {0, 1, 3}) {
    const NitschePoint &point = faces[0].points[q];
    turning += point.weight * point.turning * std::pow(point.tau.dot(d), 2);
  }
  EXPECT_NEAR(of_turning(pressures), turning, 1e-12);
  EXPECT_LT(turning, 0);
  const NitscheLine line = nitsche_line(faces, u, d, {});
  EXPECT_NEAR(line.turning, of_turning(line.start), 1e-12);
  EXPECT_LT(line.turning, 0);
}

TEST(NitscheSurface, OnlyItsOwnNormalIsTaken) {
  RigidSurface surface{.boundary = "support", .surface = disk_at, .large = true};
  surface.body_normal = [](const FullMu &, const Point &) { return Point{0, -1, 0}; };
  surface.along_body = true;
  EXPECT_THROW(by_nitsche(rigid_contact(surface), 10), Error);
  surface.along_body = false;
  surface.lumped = true;
  EXPECT_THROW(by_nitsche(rigid_contact(surface), 10), Error);
}

} // namespace
} // namespace rbvi::nitsche_surface_test
