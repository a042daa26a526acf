// Whether the law of a model with friction has other answers, before a user finds out.
#pragma once

#include "rbvi/model/model.hpp"

#include <mpi.h>

namespace rbvi {

/// Asks a model with friction whether its law has other answers (QueryOptions::looks_for_others) at
/// the parameters of `set`, shared among the ranks; empty: at those of the self-check. Where it
/// has, the model knows (has_several_answers). Costs a few times as many queries, in space twenty
/// times. Throws as OnlineSolver. Collective; the same model on every rank.
void look_for_other_answers(MPI_Comm comm, ReducedModel &model, const Scene &scene,
                            std::vector<Mu> set = {});

} // namespace rbvi
