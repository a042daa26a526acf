// Errors of a model over its validation set and on the boundary of its box.
#pragma once

#include "rbvi/study/errors.hpp"

#include <filesystem>

namespace rbvi {

/// Prints the errors of the model and of its modes alone, writes their tables to the directory
/// `out`, and stores what an answer is told of them in the model. `w`: the product of W. The sets
/// may share a scale (share_scale); `boundary` may be empty. Returns the seconds of a
/// query, the median. Serial.
double check_errors(ReducedModel &model, const SparseMatrix &w, const Truths &validation,
                    const Truths &boundary, const std::filesystem::path &out);

} // namespace rbvi
