#include "rbvi/contact/surfaces.hpp"

#include "rbvi/core/text.hpp"

#include <cmath>

namespace rbvi {

namespace {

/// From the centre, or the axis.
Point out_of(const Circle &circle, const Point &x) {
  const Point out = x - circle.centre;
  return out - dot(out, circle.axis) * circle.axis;
}

const Circle &nearest_circle(const std::vector<Circle> &circles, const Point &x) {
  const auto distance = [&](const Circle &circle) {
    return std::abs(norm(out_of(circle, x)) - circle.radius);
  };
  const Circle *nearest = &circles.front();
  for (const Circle &circle : circles)
    if (distance(circle) < distance(*nearest)) nearest = &circle;
  return *nearest;
}

Point on_circle(const Circle &circle, const Point &x) {
  const Point out = out_of(circle, x);
  return circle.centre + dot(x - circle.centre, circle.axis) * circle.axis +
         circle.radius / norm(out) * out;
}

struct OnCircle {
  Circle circle;
  Point operator()(const FullMu &, const Point &x) const { return on_circle(circle, x); }
};

Point normal_of_circle(const Circle &circle, const Point &x) {
  const Point out = out_of(circle, x);
  return (circle.hole ? -1 : 1) / norm(out) * out;
}

struct Plane {
  Point normal, pivot;
  std::function<Coefficient> position, tilt;
  Point axis;
  SurfacePoint operator()(const FullMu &mu, const Point &y) const {
    const double angle = tilt ? tilt(mu) : 0, c = std::cos(angle), s = std::sin(angle);
    const Point n = c * normal + s * cross(axis, normal) + (1 - c) * dot(axis, normal) * axis;
    const double distance = position(mu) - (y[0] - pivot[0]) * n[0] - (y[1] - pivot[1]) * n[1] -
                            (y[2] - pivot[2]) * n[2];
    if (!std::isfinite(distance))
      throw failure("the position or the tilt of a rigid plane is not finite");
    return {distance, -1.0 * n, 0};
  }
};

/// Of a disk whose numbers are functions of mu of any one type.
template <class Number> std::function<Surface> disk_of(Number x, Number y, Number radius) {
  return [=](const FullMu &mu, const Point &point) {
    const Point p{point[0] - x(mu), point[1] - y(mu), 0};
    const double distance = norm(p);
    if (!(distance > 0)) throw failure("a point of the body is at the centre of a rigid disk");
    const double inverse = 1 / distance;
    return SurfacePoint{distance - radius(mu), inverse * p, inverse};
  };
}

using Coefficients = std::array<std::function<Coefficient>, 3>;

/// Throws bad_input for a direction whose length is not 1.
void check_length(const Point &direction, const std::string &what) {
  if (!(std::abs(norm(direction) - 1) <= 1e-12))
    throw bad_input(what + " is " + place_text(direction) + ": give one of length 1");
}

Point point_at(const Coefficients &coefficients, const FullMu &mu) {
  return {coefficients[0](mu), coefficients[1](mu), coefficients[2](mu)};
}

/// A sphere, or with an axis a cylinder.
struct Round {
  Coefficients centre;
  Point axis;
  std::function<Coefficient> radius;
  SurfacePoint operator()(const FullMu &mu, const Point &y) const {
    const Point from = y - point_at(centre, mu), out = from - dot(from, axis) * axis;
    const double distance = norm(out);
    if (!(distance > 0)) throw failure("a point of the body is in the middle of what is rigid");
    return {distance - radius(mu), out / distance, 0};
  }
};

struct Cone {
  Coefficients apex;
  Point axis;
  std::function<Coefficient> angle;
  SurfacePoint operator()(const FullMu &mu, const Point &y) const {
    const Point from = y - point_at(apex, mu);
    const double along = dot(from, axis), a = angle(mu), c = std::cos(a), s = std::sin(a);
    const Point out = from - along * axis;
    const double distance = norm(out);
    if (!(distance * s + along * c > 0 && distance > 0))
      throw failure("a point of the body faces the apex of a rigid cone, or is on its axis");
    return {distance * c - along * s, c / distance * out - s * axis, 0};
  }
};

/// What phi is at a point.
struct Level {
  double value, slope;
  Point normal; ///< towards larger values
};

/// The next point of phi = 0, by Newton's method for its foot and its distance.
class LevelSet {
public:
  explicit LevelSet(std::function<PointMap> phi) : phi_(std::move(phi)) {}

  SurfacePoint operator()(const FullMu &mu, const Point &y) const {
    constexpr int most_steps = 60;
    Point foot = y;
    for (int step = 0; step < most_steps; ++step) {
      const Level at = level(mu, foot);
      const Point tau{-at.normal[1], at.normal[0], 0}, way = y - foot;
      const double distance = dot(way, at.normal), bend = curvature(mu, foot, at, tau);
      const double along = dot(way, tau) / std::max(0.1, 1 + bend * distance);
      const Point move = along * tau - at.value / at.slope * at.normal;
      foot = foot + move;
      // What is left is of the square of this, but for the differences in the curvature.
      if (!(norm(move) > 1e-13 * (norm(foot) + norm(way)))) {
        const double stretch = 1 + bend * distance;
        return {distance, at.normal, stretch > 0 ? bend / stretch : 0};
      }
    }
    throw failure("no point of the level set is found next to (" + short_number(y[0]) + ", " +
                  short_number(y[1]) + "): is it far away, or has a corner there?");
  }

private:
  Level level(const FullMu &mu, const Point &x) const {
    const Point value = phi_(mu, x); // and its gradient
    const double slope = std::hypot(value[1], value[2]);
    if (!(slope > 0) || !std::isfinite(value[0] / slope))
      throw failure("the level set of a rigid surface has no gradient at (" + short_number(x[0]) +
                    ", " + short_number(x[1]) + ")");
    return {value[0], slope, {value[1] / slope, value[2] / slope, 0}};
  }
  /// Of the level curve, by differences: how its normal turns along it.
  double curvature(const FullMu &mu, const Point &x, const Level &at, const Point &tau) const {
    const double step = 1e-5 * std::max(norm(x), std::abs(at.value / at.slope));
    if (!(step > 0)) return 0;
    const Level before = level(mu, x - step * tau), after = level(mu, x + step * tau);
    return dot(after.normal - before.normal, tau) / (2 * step);
  }

  std::function<PointMap> phi_;
};

/// How far along a unit direction the surface is, by Newton's method: from outside a convex body it
/// is monotone.
double distance_along(const std::function<Surface> &surface, const FullMu &mu, const Point &from,
                      const Point &direction) {
  double way = 0;
  for (int step = 0; step < 60; ++step) {
    const SurfacePoint there = surface(mu, from + way * direction);
    const double slope = dot(there.normal, direction);
    const double change = there.distance / slope;
    if (!std::isfinite(change)) break;
    way -= change;
    // Quadratic convergence: what is left is of the square of this.
    if (std::abs(change) <= 1e-12 * std::max(norm(from), std::abs(way))) return way;
  }
  throw failure("a line from a point of the body misses the rigid surface: use 'gap: closest'");
}

} // namespace

Point to_partner(const std::function<Surface> &surface, Partner partner, const FullMu &mu,
                 const Point &y, const Point &n) {
  if (partner == Partner::closest) {
    const SurfacePoint next = surface(mu, y);
    return -next.distance * next.normal;
  }
  const Point direction = partner == Partner::ray ? n : Point{0, n[1] < 0 ? -1.0 : 1.0, 0};
  return distance_along(surface, mu, y, direction) * direction;
}

Point on_circles(const std::vector<Circle> &circles, const Point &x) {
  return on_circle(nearest_circle(circles, x), x);
}

std::function<PointMap> on_circles(const std::vector<Circle> &circles) {
  if (circles.size() == 1) return OnCircle{circles.front()};
  return [circles](const FullMu &, const Point &x) { return on_circles(circles, x); };
}

std::function<PointMap> normals_of_circles(const std::vector<Circle> &circles) {
  if (circles.size() == 1)
    return [circle = circles.front()](const FullMu &, const Point &x) {
      return normal_of_circle(circle, x);
    };
  return [circles](const FullMu &, const Point &x) {
    return normal_of_circle(nearest_circle(circles, x), x);
  };
}

std::function<PointMap> composed(const std::function<PointMap> &outer,
                                 const std::function<PointMap> &inner) {
  const auto *scaling = outer.target<Scaling>();
  const auto *circle = inner.target<OnCircle>();
  if (scaling != nullptr && circle != nullptr)
    return [scaling = *scaling, circle = *circle](const FullMu &mu, const Point &x) {
      return scaling(mu, circle(mu, x));
    };
  return [=](const FullMu &mu, const Point &x) { return outer(mu, inner(mu, x)); };
}

std::function<Surface> plane_surface(const Point &normal, const Point &pivot,
                                     const std::function<Coefficient> &position,
                                     const std::function<Coefficient> &tilt, const Point &axis) {
  check_length(normal, "the normal of a rigid plane");
  check_length(axis, "the axis that a rigid plane is tilted about");
  return Plane{normal, pivot, position, tilt, axis};
}

std::function<Surface> sphere_surface(const Coefficients &centre,
                                      const std::function<Coefficient> &radius) {
  return Round{centre, {}, radius};
}

std::function<Surface> cylinder_surface(const Coefficients &point, const Point &axis,
                                        const std::function<Coefficient> &radius) {
  check_length(axis, "the axis of a rigid cylinder");
  return Round{point, axis, radius};
}

std::function<Surface> cone_surface(const Coefficients &apex, const Point &axis,
                                    const std::function<Coefficient> &angle) {
  check_length(axis, "the axis of a rigid cone");
  return Cone{apex, axis, angle};
}

bool is_plane(const std::function<Surface> &surface) {
  return surface.target<Plane>() != nullptr;
}

std::function<Surface> disk_surface(const std::function<Coefficient> &x,
                                    const std::function<Coefficient> &y,
                                    const std::function<Coefficient> &radius) {
  const auto *of_x = x.target<AffineCoefficient>(), *of_y = y.target<AffineCoefficient>(),
             *of_radius = radius.target<AffineCoefficient>();
  if (of_x != nullptr && of_y != nullptr && of_radius != nullptr)
    return disk_of(*of_x, *of_y, *of_radius);
  return disk_of(x, y, radius);
}

std::function<Surface> level_set(const std::function<PointMap> &value_and_gradient) {
  return LevelSet(value_and_gradient);
}

std::function<Surface> level_set(const std::function<PointValue> &phi,
                                 const std::function<PointMap> &gradient) {
  return [=](const FullMu &mu, const Point &y) -> SurfacePoint {
    constexpr int most_steps = 200;
    Point foot = y;
    for (int step = 0; step < most_steps; ++step) {
      const Point slopes = gradient(mu, foot);
      const double value = phi(mu, foot), slope = norm(slopes);
      if (!(slope > 0) || !std::isfinite(value / slope))
        throw failure("the level set of a rigid surface has no gradient at " + place_text(foot));
      // The foot of y on the plane that touches the level surface of phi there.
      const Point normal = slopes / slope, way = y - foot;
      const double distance = dot(way, normal);
      const Point move = way - (distance + value / slope) * normal;
      foot = foot + move;
      if (!(norm(move) > 1e-13 * (norm(foot) + norm(way)))) return {distance, normal, 0};
    }
    throw failure("no point of the level set is found next to " + place_text(y) +
                  ": is it far away, or has a corner there?");
  };
}

} // namespace rbvi
