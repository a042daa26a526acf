#include "rbvi/core/places.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

double length(const Point &a, const Point &b) {
  return std::hypot(b[0] - a[0], b[1] - a[1]);
}

} // namespace

Place box(const Point &low, const Point &high) {
  return [=](const Point &x) {
    const double right = std::max(low[0] - x[0], x[0] - high[0]);
    const double above = std::max(low[1] - x[1], x[1] - high[1]);
    if (std::max(right, above) <= 0) return std::max(right, above);
    return std::hypot(std::max(right, 0.0), std::max(above, 0.0));
  };
}

Place disk(const Point &centre, double radius) {
  return [=](const Point &x) { return length(centre, x) - radius; };
}

Place common_part(const Place &a, const Place &b) {
  return [=](const Point &x) { return std::max(a(x), b(x)); };
}

Place rim(const Place &filled) {
  return [=](const Point &x) { return std::abs(filled(x)); };
}

Place segment(const Point &a, const Point &b) {
  return [=](const Point &x) {
    const double dx = b[0] - a[0], dy = b[1] - a[1];
    const double along = ((x[0] - a[0]) * dx + (x[1] - a[1]) * dy) / (dx * dx + dy * dy);
    const double t = std::clamp(along, 0.0, 1.0);
    return length({a[0] + t * dx, a[1] + t * dy, 0}, x);
  };
}

Place arc(const Point &centre, double radius, double angle, double half_angle) {
  return [=](const Point &x) {
    const double dx = x[0] - centre[0], dy = x[1] - centre[1];
    const double c = std::cos(angle), s = std::sin(angle);
    const double turned = std::atan2(c * dy - s * dx, c * dx + s * dy);
    if (std::abs(turned) <= half_angle) return std::abs(std::hypot(dx, dy) - radius);
    const double end = angle + (turned < 0 ? -half_angle : half_angle);
    return length({centre[0] + radius * std::cos(end), centre[1] + radius * std::sin(end), 0}, x);
  };
}

Place nearest(std::vector<Place> places) {
  return [places = std::move(places)](const Point &x) {
    double least = std::numeric_limits<double>::infinity();
    for (const Place &place : places)
      least = std::min(least, place(x));
    return least;
  };
}

} // namespace rbvi
