// Points of a mesh, and indices into its vectors.
#pragma once

#include "rbvi/element/geometry.hpp"

#include <cmath>
#include <cstddef>

namespace rbvi {

inline std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

inline double distance(const Point &x, const Point &y) {
  return std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]);
}

} // namespace rbvi
