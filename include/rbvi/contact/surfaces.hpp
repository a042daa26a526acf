// Circles as boundaries of bodies, disks as rigid surfaces, and gaps to them: what supports
// (contact/support.hpp) of scenes from files are made of.
#pragma once

#include "rbvi/core/functions.hpp"

namespace rbvi {

/// In the reference domain. A hole is a circle whose body is outside.
struct Circle {
  Point centre{};
  double radius = 1;
  bool hole = false;
};

/// The point of the nearest of these circles that is next to x.
Point on_circles(const std::vector<Circle> &circles, const Point &x);
std::function<PointMap> on_circles(const std::vector<Circle> &circles);
/// The unit normal of the nearest circle, out of the body.
std::function<PointMap> normals_of_circles(const std::vector<Circle> &circles);

/// outer(mu, inner(mu, x)).
std::function<PointMap> composed(const std::function<PointMap> &outer,
                                 const std::function<PointMap> &inner);

/// The outside of a disk about (x, y).
std::function<Surface> disk_surface(const std::function<Coefficient> &x,
                                    const std::function<Coefficient> &y,
                                    const std::function<Coefficient> &radius);

/// Where a function is positive, value_and_gradient = (phi, phi_x, phi_y) (core/formula.hpp). The
/// next point of phi = 0 is looked for from the point itself, along the gradient. Evaluation throws
/// failure where none is found, or phi has no gradient.
std::function<Surface> level_set(const std::function<PointMap> &value_and_gradient);

/// Unit normal, out of the body, of a surface that the point at(mu, x) faces: -(gradient of the
/// distance).
std::function<PointMap> normal_of_surface(const std::function<Surface> &surface,
                                          const std::function<PointMap> &at);

/// What the partner of a point on the surface is.
enum class GapKind {
  closest, ///< the next point
  ray,     ///< along the normal of contact
  vertical ///< along e_y
};

/// What gap_to_surface makes; `along` takes a normal that is known already.
struct GapToSurface {
  std::function<Surface> surface;
  std::function<PointMap> at, normal;
  GapKind kind;
  double operator()(const FullMu &mu, const Point &x) const { return along(mu, x, normal(mu, x)); }
  double along(const FullMu &mu, const Point &x, const Point &n) const;
  Point partner(const FullMu &mu, const Point &x) const;

private:
  struct Way {
    double length;
    Point direction;
  };
  Way way(const FullMu &mu, const Point &from, const Point &n) const;
};

/// (partner - at) . normal, at = at(mu, x) (Niakh 2022, (3.4)). Evaluation throws failure where the
/// line misses the surface.
std::function<PointValue> gap_to_surface(const std::function<Surface> &surface,
                                         const std::function<PointMap> &at,
                                         const std::function<PointMap> &normal, GapKind kind);

} // namespace rbvi
