// The parts of verify: errors over the validation set and on the boundary of the box, stability.
#pragma once

#include "rbvi/fem/problem.hpp"
#include "rbvi/model/model.hpp"
#include "rbvi/study/errors.hpp"

#include <filesystem>
#include <string>

namespace rbvi {

/// Prints the errors of the model and of its modes alone, writes their tables to the directory
/// `out`, and stores what an answer is told of them in the model. `w`: the product of W. The sets
/// may share a scale (share_scale); `boundary` may be empty; `only`: outputs that are asked for
/// (is_asked). Returns the seconds of a query with its outputs, the median. Serial.
double check_errors(ReducedModel &model, const SparseMatrix &w, const Truths &validation,
                    const Truths &boundary, const std::vector<std::string> &only,
                    const std::filesystem::path &out);

/// Why there are no inf-sup constants to verify; empty: there are.
std::string no_constants(const ReducedModel &model);

/// What the model promises about stability, checked at every training and validation mu, where
/// contact follows the displacement at every step of their iterations: infsup.csv
/// and stability.csv into `out`, a summary to standard output. Collective.
void check_stability(MPI_Comm world, Problem &problem, const ReducedModel &model,
                     const std::vector<ContactPoint> &training,
                     const std::vector<ContactPoint> &validation, const std::filesystem::path &out);

} // namespace rbvi
