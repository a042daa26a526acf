// The stages of an offline run as one table: before the run what will be done, after it what was
// done and how long it took, and in both what is skipped and why.
#pragma once

#include "rbvi/mor/stages.hpp"
#include "rbvi/tool/options.hpp"

namespace rbvi {

namespace stage {
inline constexpr StageName mesh("mesh"), snapshots("snapshots"),
    distributed_mesh("distributed mesh"), writing("writing");
} // namespace stage

/// What runs before the reduction. `sweep` null: as planned.
StageTable preparation_stages(const ToolOptions &options, std::size_t training,
                              const Groups &groups, const SweepReport *sweep = nullptr);

/// What runs after the reduction.
StageTable closing_stages();

/// Stage, seconds (nothing where no time is known) or "skipped", what; where anything was timed,
/// the total.
void print_stages(const std::vector<StageTable> &tables);

} // namespace rbvi
