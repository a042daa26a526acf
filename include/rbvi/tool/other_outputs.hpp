// The model of a run whose outputs alone have changed.
#pragma once

#include "rbvi/tool/offline_run.hpp"

#include <optional>

namespace rbvi {

/// The model that is in the run directory, with the outputs of this scene in place of its own:
/// where it is of these samples, box and settings, and was made for other outputs. Empty: all else.
/// On the first rank, the others have an empty model. Collective on `world`.
std::optional<ReducedModel> with_other_outputs(MPI_Comm world, const OfflineOptions &options,
                                               const Problem &problem, const Sweep &sweep);

} // namespace rbvi
