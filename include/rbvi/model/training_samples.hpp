// The parameters that a model was trained at, those at which there was no sample, and those of its
// validation.
#pragma once

#include "rbvi/model/model.hpp"

#include <functional>
#include <vector>

namespace rbvi {

/// What outputs a model has: `answer` at the first of its training parameters, or of some random
/// ones, where this throws no Error; none where it always does.
Outputs example_outputs(const ReducedModel &model,
                        const std::function<Outputs(const Mu &)> &answer);

/// The outputs that a table of the model has, but for the time that each answer takes.
std::vector<OutputColumn> columns_of_model(const ReducedModel &model);

/// Throws bad_input, naming the nearest, for an output that a table of the model has not.
void check_asked(const std::vector<std::string> &only, const ReducedModel &model);

/// free parameters x samples, as ModelHistory::trained_mu; `rows`: number of free parameters.
Matrix as_columns(const std::vector<Mu> &set, int rows);

/// One Mu per column.
std::vector<Mu> from_columns(const Matrix &columns);

/// Whether the training parameter nearest to `free` (one value per free parameter) has no sample:
/// there the model was trained on what lies around. Distances are measured in parts of the box;
/// false for a model without failed samples.
bool nearest_sample_failed(const ReducedModel &model, const Mu &free);

/// Whether errors were measured, and `free` is nearer to a corner or a face of the box than any
/// parameter at which they were (nearer_to_boundary).
bool beyond_validation(const ReducedModel &model, const Mu &free);

} // namespace rbvi
