// The functions that scenes are made of, by what they take and return, and those that many scenes
// share.
#pragma once

#include "rbvi/core/parameters.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <string>

namespace rbvi {

using Point = std::array<double, 3>; ///< and vectors; in 2D the third coordinate is zero

inline Point operator+(const Point &x, const Point &y) {
  return {x[0] + y[0], x[1] + y[1], x[2] + y[2]};
}
inline Point operator-(const Point &x, const Point &y) {
  return {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
}
inline Point operator*(double factor, const Point &x) {
  return {factor * x[0], factor * x[1], factor * x[2]};
}
inline Point operator/(const Point &x, double divisor) {
  return {x[0] / divisor, x[1] / divisor, x[2] / divisor};
}
inline double dot(const Point &x, const Point &y) {
  return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
}
/// In 2D along the third axis.
inline Point cross(const Point &x, const Point &y) {
  return {x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]};
}
inline double norm(const Point &x) {
  return std::sqrt(dot(x, x));
}

/// "(1, 0, 0.5)".
std::string place_text(const Point &x);

/// One simplex: dim + 1 vertices, in the reference and in the mapped domain.
struct Cell {
  int dim = 2;
  std::array<Point, 4> reference; ///< vertices xhat
  std::array<Point, 4> mapped;    ///< h(mu)(xhat)
  /// Of each dof of a form's nodes, the fixed boundary that imposes a value on it (its number in
  /// Scene::fixed), or -1; null: none does. For the forms of element/imposed.hpp.
  const int *imposed_by = nullptr;
  /// State of contact: the displacement at the nodes, node * components + c, beside the motion of
  /// the scene; null: at rest.
  const double *displacement = nullptr;
};

/// A rigid surface as a point y sees it.
struct SurfacePoint {
  double distance;  ///< of y, signed: negative inside
  Point normal;     ///< gradient of the distance: at the next point of the surface, towards y
  double curvature; ///< second derivative of the distance along the tangent (2D; 0 in space): of a
                    ///< disk 1 over the distance from its centre
};

/// The two constants of an isotropic material, pressures:
/// sigma = lambda tr(eps) I + 2 shear eps.
struct Lame {
  double lambda, shear;
};

using NumberMap = double(double x);
using Coefficient = double(const FullMu &mu); ///< theta, a coefficient of friction, ...
using Check = void(const FullMu &mu);         ///< throws bad_input
using PointValue = double(const FullMu &mu, const Point &x);
using PointMap = Point(const FullMu &mu, const Point &x);
using Surface = SurfacePoint(const FullMu &mu, const Point &y);
using Material = Lame(const FullMu &mu, const Point &x);
using Kernel = void(const FullMu &mu, const Cell &cell, double *values); ///< see Form
/// A force per length or area at a point x of the mapped boundary, n its unit normal outwards.
using Traction = Point(const FullMu &mu, const Point &x, const Point &n);

/// Values in those of fields (core/formula.hpp) at so many points, both column by column.
using FieldValues = void(const FullMu &mu, const double *fields, std::size_t count,
                         double *results);

/// Coordinates of parameters: x -> log x and back, x -> log(1 - 2 x) and back.
std::function<NumberMap> logarithm();
std::function<NumberMap> exponential();
std::function<NumberMap> logarithm_to_half();
std::function<NumberMap> exponential_to_half();

/// What affine, parameter and constant make; functions that are made of them evaluate it directly.
struct AffineCoefficient {
  double value = 0, factor = 0;
  std::size_t index = 0;
  double operator()(const FullMu &mu) const {
    return factor == 0 ? value : value + factor * mu.at(index);
  }
};

/// value + factor (the parameter of this index in parameters.all).
std::function<Coefficient> affine(double value, double factor, int index);
/// The value of a parameter, and of none.
std::function<Coefficient> parameter(int index);
std::function<Coefficient> constant(double value);

std::function<PointMap> identity();
bool is_identity(const std::function<PointMap> &map);
/// Whether a map is the same at all points: one that everywhere() makes.
bool is_everywhere(const std::function<PointMap> &map);
/// The same at all points for all mu.
std::function<PointValue> everywhere(double value);
std::function<PointMap> everywhere(const Point &vector);
/// Up to three components.
std::function<PointMap> everywhere(const std::vector<std::function<Coefficient>> &components);
std::function<Material> everywhere(const Lame &material);
/// The same at all points.
std::function<PointValue> everywhere(const std::function<Coefficient> &value);
/// x -> scale x. Of an affine scale it is a Scaling.
struct Scaling {
  AffineCoefficient scale;
  Point operator()(const FullMu &mu, const Point &x) const { return scale(mu) * x; }
};
std::function<PointMap> scaled(const std::function<Coefficient> &scale);

} // namespace rbvi
