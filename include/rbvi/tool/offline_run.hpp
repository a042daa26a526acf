// The pipeline behind rbvi offline, without what it prints: samples, reduction, model file.
#pragma once

#include "rbvi/par/groups.hpp"
#include "rbvi/tool/stages.hpp"

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
std::vector<Mu> checked_training(const ToolOptions &options);

/// Solves at the training set by groups of ranks, reduces, and writes the run directory of the
/// options. Throws failure if more samples fail than the options allow. Collective on `world`.
OfflineRun run_offline(MPI_Comm world, const Groups &groups, const ToolOptions &options,
                       const std::vector<Mu> &training);

} // namespace rbvi
