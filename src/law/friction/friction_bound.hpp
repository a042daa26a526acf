// What all solvers of friction check and name alike.
#pragma once

#include "rbvi/core/error.hpp"
#include "rbvi/law/friction/friction.hpp"

#include <cmath>

namespace rbvi::friction {

/// What x_tau of a node is: zero, free, or of a given direction.
enum class Tangent : char { none, stick, slip };

/// Throws bad_input for a coefficient or a threshold that is negative or not finite.
inline void check(const FrictionBound &bound) {
  const bool valid = std::isfinite(bound.coefficient) && std::isfinite(bound.threshold) &&
                     bound.coefficient >= 0 && bound.threshold >= 0;
  if (!valid) throw bad_input("the coefficient and the threshold of friction must not be negative");
}

} // namespace rbvi::friction
