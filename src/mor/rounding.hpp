// Entries of a model without digits that mean nothing, which then need no room in a file
// (io/h5.cpp).
#pragma once

#include "rbvi/core/dense.hpp"

#include <cmath>

namespace rbvi {

/// To multiples of the largest power of two up to `step`.
inline void round_entries(Eigen::Ref<Matrix> entries, double step) {
  const double unit = std::exp2(std::floor(std::log2(step)));
  entries = (entries.array() / unit).round() * unit;
}

} // namespace rbvi
