// Boundaries on a rigid support and scenes for tests of its operators.
#pragma once

#include "curves.hpp"
#include "rbvi/contact/support.hpp"

#include <functional>

namespace rbvi {

using PointField = std::function<Point(const Point &)>;

inline Point turned(const Point &n) { // tau of n
  return {-n[1], n[0], 0};
}

inline Point between(const Point &a, const Point &b, double s) {
  return {(1 - s) * a[0] + s * b[0], (1 - s) * a[1] + s * b[1], 0};
}

/// A boundary with its middles (degree 2): column = node * 2 + component.
inline InterfaceMesh support_curve(const Curve &vertices, int degree) {
  InterfaceMesh mesh = curve_mesh(vertices, degree);
  mesh.parts = {static_cast<int>(mesh.nodes())};
  mesh.components = 2;
  mesh.columns = 2 * mesh.nodes();
  for (int dof = 0; dof < mesh.columns; ++dof)
    mesh.dofs.push_back(dof);
  return mesh;
}

inline Index vertices_of(const InterfaceMesh &curve) {
  return curve.count() + 1;
}

/// Displacements of the nodes of a field.
inline Vector nodal(const InterfaceMesh &curve, const PointField &field) {
  Vector v(2 * curve.nodes());
  for (Index i = 0; i < curve.nodes(); ++i) {
    const Point value = field(curve.points[i]);
    v.segment<2>(2 * i) << value[0], value[1];
  }
  return v;
}

/// A scene and the support that its body meets, before it is the scene's contact.
struct SupportScene : Scene {
  Support support;
};

/// The operators of multipliers on a boundary at mu.
inline ContactOperators couple_with_support(const SupportScene &scene, const FullMu &mu,
                                            const InterfaceMesh &curve) {
  ContactOperators operators;
  rigid_support(scene.support).make(scene, curve)->assemble_all(mu, {}, operators);
  return operators;
}

/// Their dual space.
inline DualSpace dual_of(const SupportScene &scene, const InterfaceMesh &curve) {
  return rigid_support(scene.support).make(scene, curve)->dual();
}

/// Identical map, with friction, constant normal and no gap.
inline SupportScene support_scene(int degree, const Point &normal = {0, -1, 0}) {
  SupportScene scene;
  scene.components = 2;
  scene.degree = degree;
  scene.parameters.all = {{"size", "", 0, 2, 1}};
  scene.map = [](const FullMu &, const Point &x) { return x; };
  scene.support = {"support",
                   [normal](const FullMu &, const Point &) { return normal; },
                   [](const FullMu &, const Point &) { return 0.0; },
                   {FrictionLaw::coulomb, [](const FullMu &) { return 0.3; }}};
  return scene;
}

/// Vertices of an arc about the origin, below it; symmetric spacing about x = 0.
inline Curve arc(Index edges, double half_angle) {
  Curve curve;
  for (Index i = 0; i <= edges; ++i) {
    const double angle =
        half_angle * static_cast<double>(2 * i - edges) / static_cast<double>(edges);
    curve.push_back({std::sin(angle), -std::cos(angle), 0});
  }
  return curve;
}

inline Point radial(const FullMu &, const Point &x) {
  const double r = std::hypot(x[0], x[1]);
  return {x[0] / r, x[1] / r, 0};
}

/// A half disk of radius mu[0] above the line y = -mu[0].
inline SupportScene hertz(int degree) {
  SupportScene scene = support_scene(degree);
  scene.map = [](const FullMu &mu, const Point &x) { return Point{mu[0] * x[0], mu[0] * x[1], 0}; };
  scene.support.normal = scene.support.body_normal = radial;
  scene.support.gap = [](const FullMu &mu, const Point &x) {
    const double r = std::hypot(x[0], x[1]);
    return mu[0] * (r / -x[1] - 1);
  };
  return scene;
}

/// Nothing is constant.
inline SupportScene crooked(int degree) {
  SupportScene scene = support_scene(degree);
  scene.map = [](const FullMu &mu, const Point &x) {
    return Point{mu[0] * x[0] + 0.2 * x[1], x[1] + 0.3 * std::sin(2 * x[0]), 0};
  };
  scene.support.normal = [](const FullMu &mu, const Point &x) {
    const double angle = mu[0] + x[0] * x[1];
    return Point{std::cos(angle), std::sin(angle), 0};
  };
  scene.support.gap = [](const FullMu &, const Point &x) { return 0.1 + std::cos(x[0]); };
  scene.motion = [](const FullMu &mu, const Point &x) {
    return Point{std::sin(x[0]), mu[0] * std::exp(x[1]), 0};
  };
  return scene;
}

} // namespace rbvi
