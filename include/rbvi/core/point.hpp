// Points and vectors; in 2D the third coordinate is zero.
#pragma once

#include <array>
#include <cmath>

namespace rbvi {

using Point = std::array<double, 3>;

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

} // namespace rbvi
