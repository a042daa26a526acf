// What every method of contact returns at one mu, on a full body and on a reduced one.
#pragma once

#include "rbvi/core/outputs.hpp"

#include <optional>
#include <string>

namespace rbvi {

struct Answer {
  Vector u;            ///< displacement: at all dofs, or coefficients of the primal basis
  Vector lambda;       ///< multipliers: at the dual dofs, or coefficients of the dual basis
  Vector start;        ///< for a nearby problem (FrictionResult::start); empty: lambda itself
  double residual = 0; ///< of all conditions, relative: the largest
  int iterations = 0;  ///< changes of active sets, Newton steps, or linearisations
  /// Where contact follows the displacement: as in Outputs.
  std::optional<double> load_steps{}, contraction{};
  std::string reason; ///< why the method stopped
};

/// Sets the outputs that tell how it was found.
inline void tell(const Answer &answer, Outputs &outputs) {
  outputs.kkt_residual = answer.residual;
  outputs.iterations = answer.iterations;
  outputs.load_steps = answer.load_steps;
  outputs.contraction = answer.contraction;
}

} // namespace rbvi
