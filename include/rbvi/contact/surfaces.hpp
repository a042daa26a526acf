// Circles, spheres and cylinders as boundaries of bodies, and what is rigid: planes, disks,
// spheres, cylinders, cones and level sets are one Surface (core/functions.hpp), which tells a
// point the way to its closest point of them.
#pragma once

#include "rbvi/core/functions.hpp"

namespace rbvi {

/// In the reference domain. A hole is one whose body is outside.
struct Circle {
  Point centre{};
  double radius = 1;
  bool hole = false;
  Point axis{}; ///< of a cylinder, of length 1; zero: a circle in the plane, a sphere in space
};

/// The point of the nearest of these circles that is next to x.
Point on_circles(const std::vector<Circle> &circles, const Point &x);
std::function<PointMap> on_circles(const std::vector<Circle> &circles);
/// The unit normal of the nearest circle, out of the body.
std::function<PointMap> normals_of_circles(const std::vector<Circle> &circles);

/// outer(mu, inner(mu, x)).
std::function<PointMap> composed(const std::function<PointMap> &outer,
                                 const std::function<PointMap> &inner);

/// The half-plane beside a straight line, or half-space beside a plane, whose position and tilt can
/// be parameters. With n the unit normal, which points out of the body that touches it,
///
///   distance = position - (y - pivot) . n.
///
/// `normal`: without tilt; `tilt`: radians, by which the plane turns about the pivot,
/// counterclockwise seen against the unit vector `axis`; empty: none. Throws bad_input for a normal
/// or an axis whose length is not 1. Evaluation throws failure where position or tilt is not finite.
std::function<Surface> plane_surface(const Point &normal, const Point &pivot,
                                     const std::function<Coefficient> &position,
                                     const std::function<Coefficient> &tilt = {},
                                     const Point &axis = {0, 0, 1});
bool is_plane(const std::function<Surface> &surface);

/// The outside of a disk about (x, y).
std::function<Surface> disk_surface(const std::function<Coefficient> &x,
                                    const std::function<Coefficient> &y,
                                    const std::function<Coefficient> &radius);

/// In space, the outside of a sphere, and of an endless cylinder about the line through a point
/// along a unit vector.
std::function<Surface> sphere_surface(const std::array<std::function<Coefficient>, 3> &centre,
                                      const std::function<Coefficient> &radius);
std::function<Surface> cylinder_surface(const std::array<std::function<Coefficient>, 3> &point,
                                        const Point &axis,
                                        const std::function<Coefficient> &radius);
/// The outside of an endless cone that opens along a unit vector; `angle`: between its axis and its
/// side, radians. Evaluation throws failure where the apex is the next point.
std::function<Surface> cone_surface(const std::array<std::function<Coefficient>, 3> &apex,
                                    const Point &axis, const std::function<Coefficient> &angle);

/// Where a function is positive, value_and_gradient = (phi, phi_x, phi_y) (core/formula.hpp). The
/// next point of phi = 0 is looked for from the point itself, along the gradient. Evaluation throws
/// failure where none is found, or phi has no gradient.
std::function<Surface> level_set(const std::function<PointMap> &value_and_gradient);
/// In space, of phi and its gradient apart.
std::function<Surface> level_set(const std::function<PointValue> &phi,
                                 const std::function<PointMap> &gradient);

/// Which point of the surface one of the body faces (Niakh 2022, (3.4)).
enum class Partner {
  closest,
  ray,     ///< along the normal of contact
  vertical ///< along e_y
};

/// From y to its partner, of contact with the unit normal n, out of the body. Throws failure where
/// the line misses the surface.
Point to_partner(const std::function<Surface> &surface, Partner partner, const FullMu &mu,
                 const Point &y, const Point &n);

} // namespace rbvi
