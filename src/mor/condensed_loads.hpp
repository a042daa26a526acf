// Loads on single contact dofs.
#pragma once

#include "rbvi/core/dense.hpp"

#include <vector>

namespace rbvi {

/// Ones at some of the contact dofs, a column each.
template <class Integer> Matrix unit_loads(Index dofs, const std::vector<Integer> &at) {
  Matrix loads = Matrix::Zero(dofs, std::ssize(at));
  for (Index k = 0; k < loads.cols(); ++k)
    loads(at[k], k) = 1;
  return loads;
}

} // namespace rbvi
