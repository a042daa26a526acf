// What the points of a boundary face: a rigid surface from where the body is at rest, or from where
// it now is (large deformations). Contact by multipliers (contact/support.hpp) and by
// Nitsche's method (contact/nitsche.hpp) ask nothing else of what is faced.
// Niakh (2022): (3.4), (3.5).
#pragma once

#include "rbvi/contact/friction.hpp"
#include "rbvi/core/scene.hpp"

#include <array>

namespace rbvi {

/// A point of the reference boundary at one mu.
struct PlacedPoint {
  Point x;
  Point motion; ///< of the scene
  Point y;      ///< where the body is at rest, without the motion
};

/// normal . w <= gap for the displacement w of a point, and the slip tau . (motion + w),
/// tau = (-n_y, n_x).
struct FacedPoint {
  Point normal;         ///< of length 1, out of the body
  double gap;           ///< less the motion's share
  double slip;          ///< of the motion
  double curvature = 0; ///< of what is faced: SurfacePoint
};

struct Facing {
  /// Where a point of an edge is on the curve that the edge stands for (on_arcs), before anything
  /// else is asked; empty: there.
  std::function<Point(const Point &)> on_curve{};
  /// `displacement`: the state there, which the condition is linearised about; at rest ignored.
  std::function<FacedPoint(const FullMu &mu, const PlacedPoint &point, const Point &displacement)>
      at;
  /// The point that is faced at rest, for pictures; empty: it lies along the normal.
  std::function<Point(const FullMu &mu, const PlacedPoint &point)> partner{};
  /// How far from what it really faces the point is after `moved`, the motion and the displacement;
  /// empty: as far as `at` says.
  std::function<double(const FullMu &mu, const PlacedPoint &point, const Point &moved)> distance{};
  /// The normal alone, for less work, where it is a function of the place; or empty.
  std::function<PointMap> normal{};
  /// Where a point of the reference boundary is at rest; empty: where the map takes it.
  std::function<PointMap> at_rest{};
  bool follows_state = false;
  /// The unit normal of the body's exact boundary at a point of the reference boundary, out of the
  /// mapped body.
  std::function<PointMap> body_normal{};
  /// The condition is one along that normal, of the deformed body. Only where it follows the state.
  bool along_body = false;
};

inline Point curve_point(const Facing &facing, const Point &x) {
  return facing.on_curve ? facing.on_curve(x) : x;
}

inline PlacedPoint place(const Scene &scene, const Facing &facing, const FullMu &mu,
                         const Point &of_edge) {
  const Point x = curve_point(facing, of_edge);
  return {x, scene.motion ? scene.motion(mu, x) : Point{},
          facing.at_rest ? facing.at_rest(mu, x) : scene.map(mu, x)};
}

/// motion . tau.
inline double slip_along(const Point &n, const Point &motion) {
  return motion[1] * n[0] - motion[0] * n[1];
}

/// Contact of a boundary with something rigid, before it is by multipliers or by Nitsche's method.
struct RigidContact {
  std::string boundary;
  Facing facing;
  Friction friction;
  bool lumped; ///< vertex quadrature
  /// Edges that are in a boundary of Scene::curves stand for its arcs (of degree 2).
  bool curved = false;
};

/// The load that pulls the boundary onto what it faces at rest: int a n . v, a =
/// Friction::adhesion, by the quadrature of its multipliers, for the displacement of the scene.
/// Whoever adds it to one sets Term::of_contact.
Term adhesive_load(const RigidContact &rigid, const Scene &scene);

} // namespace rbvi
