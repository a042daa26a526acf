// Bounds of errors over true errors, in the energy norm at each parameter.
#pragma once

#include "rbvi/fem/problem.hpp"
#include "rbvi/model/model.hpp"
#include "rbvi/sweep/sweep.hpp"

#include <iosfwd>
#include <map>

namespace rbvi {

struct Effectivities {
  std::vector<double> values;     ///< bound / |u - u_N|, of bounds
  std::vector<double> indicators; ///< likewise of indicators
  /// Answers whose error is that of the high-fidelity solver, 1e-8 of the largest |u|, or less.
  int exact = 0;
  int without = 0; ///< answers that have no bound
  /// Of each output that has intervals the widest, over the largest a(u, u) or normal force.
  std::map<std::string, double> widths;
  /// Bounds below the error, and outputs outside of their interval, by more than the error of the
  /// high-fidelity solver.
  int wrong = 0;
};

/// Of the model's answers at samples with their fields, which must be those of the model. Nothing
/// where the model keeps nothing for bounds. Collective on the problem's communicator.
Effectivities effectivities(Problem &problem, const ReducedModel &model,
                            const std::vector<Sample> &samples);

/// "Bounds of u: 1.01 to 1.43 times the error, median 1.2, over 12 answers", and of intervals.
void print_effectivities(std::ostream &out, const Effectivities &found);

} // namespace rbvi
