// The largest of some numbers, which is NaN where one of them is: std::max passes over it.
#pragma once

#include <cmath>
#include <initializer_list>
#include <limits>

namespace rbvi {

inline double larger(double a, double b) {
  return a >= b || std::isnan(a) ? a : b;
}

inline double largest(std::initializer_list<double> values) {
  double result = -std::numeric_limits<double>::infinity();
  for (const double value : values)
    result = larger(result, value);
  return result;
}

} // namespace rbvi
