// Points of a mesh.
#pragma once

#include "rbvi/element/geometry.hpp"

#include <cmath>

namespace rbvi {

inline double distance(const Point &x, const Point &y) {
  return std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]);
}

} // namespace rbvi
