// The pipeline behind rbvi offline, without what it prints: samples, reduction, model file.
#pragma once

#include "rbvi/par/groups.hpp"
#include "rbvi/tool/foreseen.hpp"
#include "rbvi/tool/workspace.hpp"

namespace rbvi {

struct OfflineRun {
  Sweep sweep;
  ReducedModel model;
  std::vector<StageTable> stages; ///< what was done, timed
  int nodes = 0, dofs = 0;        ///< of the mesh, constrained ones included
  int multipliers = 0;
};

/// The training set of the options. Throws bad_input where it, the reduction or the options of
/// SLEPc's objects do not fit the scene.
std::vector<Mu> checked_training(const OfflineOptions &options);

/// A run before its first solve.
struct OfflinePlan {
  std::vector<StageTable> stages; ///< that will run
  StageTable before;              ///< the first of them: the mesh is made
  Workspace work;
  HfOptions hf; ///< of the solves of a group
  Foresight foreseen;
  NodeMemory room; ///< with what the ranks hold
};

/// Makes the mesh, and foresees what the stages will take. Throws bad_input, as check_memory() does
/// with what is known, before the mesh is made; whether there is room for all stages is for
/// run_offline() to ask. Collective on `world`.
OfflinePlan plan_offline(MPI_Comm world, const Groups &groups, const OfflineOptions &options,
                         const std::vector<Mu> &training);

/// Solves at the training set by groups of ranks, reduces, unless the model that is there lacks
/// outputs alone, and writes the run directory of the options. Throws bad_input as check_memory()
/// does, failure if more samples fail than the options allow. Collective on `world`.
OfflineRun run_offline(MPI_Comm world, const Groups &groups, const OfflineOptions &options,
                       const std::vector<Mu> &training, OfflinePlan plan);

} // namespace rbvi
