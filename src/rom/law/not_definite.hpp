// What is said where a reduced stiffness has no Cholesky factor.
#pragma once

#include "rbvi/core/error.hpp"

namespace rbvi {

inline Error stiffness_not_definite() {
  return failure("the reduced stiffness is not positive definite: reduce again with a smaller "
                 "-eim_tolerance, or stay closer to the training set");
}

} // namespace rbvi
