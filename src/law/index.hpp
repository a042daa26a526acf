// Eigen counts with signed numbers, the standard containers with unsigned ones.
#pragma once

#include "rbvi/core/dense.hpp"

#include <cstddef>

namespace rbvi {

/// The position of entry i in a standard container; i >= 0.
inline std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

} // namespace rbvi
