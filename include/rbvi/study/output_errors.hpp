// Errors of what people ask a model for: energies, forces, pressures, widths.
#pragma once

#include "rbvi/model/online.hpp"

#include <vector>

namespace rbvi {

/// One answer with all outputs, min_u among them where the model has its fields.
Outputs outputs_with_field(const OnlineSolver &solver, const Mu &mu, const ReducedAnswer &solution);

/// The outputs of the model at each mu, in or out of its box; nothing is set where it has no
/// answer. `only`: outputs that are asked for (is_asked). Serial.
std::vector<Outputs> reduced_outputs(const ReducedModel &model, const std::vector<Mu> &set,
                                     const std::vector<std::string> &only = {});

/// Seconds of a query of the model with these outputs, without min_u, the median over the set.
/// Serial.
double seconds_with_outputs(const ReducedModel &model, const std::vector<Mu> &set,
                            const std::vector<std::string> &only);

/// Errors of every column that `truth` and `reduced` have, but for seconds and iterations, over
/// those mu where both are set. `reduced`: of the first of the mu of `truth`, or of all. The range
/// is that of the true values, at least a hundredth of their largest magnitude; a value that errors
/// are compared with is taken to have at least that size too, so that nothing is relative to a
/// number near 0. For horizontal_reaction, which symmetry makes vanish, it is a hundredth of the
/// largest normal_force.
std::vector<OutputError> output_errors(const std::vector<Outputs> &reduced,
                                       const std::vector<Outputs> &truth);

/// The largest error over the range of any energy, force or pressure; negative where there is none.
double largest_output_error(const std::vector<Outputs> &reduced, const std::vector<Outputs> &truth);

} // namespace rbvi
