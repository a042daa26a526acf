// A finished model in place of a case: verify and bench measure the model that there is.
#pragma once

#include "rbvi/tool/options.hpp"

namespace rbvi {

/// The model in the run directory of the options. Throws bad_input. Collective.
ReducedModel model_of_run(MPI_Comm world, const OfflineOptions &options);

/// Takes scene, options, fixed values, box and mesh of the options from the model. Rank 0 prints
/// one line that says where they differed. Throws bad_input for a model of another scene.
MeasureOptions adopt_model(MeasureOptions options, const ReducedModel &model);

/// The validation set of the options. Rank 0 warns of parameters at which the model was trained, as
/// two random sets of one seed have. Throws bad_input.
std::vector<Mu> validation_set(const MeasureOptions &options, const ReducedModel &model);

/// Throws bad_input unless mesh and scene of the problem are the model's, functions included.
void check_problem(const Problem &problem, const ReducedModel &model,
                   const std::filesystem::path &out);

} // namespace rbvi
