// The stages of an offline run as one table: before the run what will be done, after it what was
// done and how long it took, and in both what is skipped and why.
#pragma once

#include "rbvi/mor/stages.hpp"
#include "rbvi/tool/options.hpp"

#include <map>

namespace rbvi {

namespace stage {
inline constexpr StageName mesh("mesh"), snapshots("snapshots"),
    distributed_mesh("distributed mesh"), writing("writing");
} // namespace stage

/// What runs before the reduction. `sweep` null: as planned.
StageTable preparation_stages(const Setup &setup, std::size_t training, const Groups &groups,
                              const SweepReport *sweep = nullptr);

/// What runs after the reduction.
StageTable closing_stages();

/// What a stage will take.
struct Foreseen {
  double first = 0, others = 0; ///< bytes: largest resident set of the first rank, of each other
  double seconds = 0;           ///< 0: hangs on what the stages before it find
};
/// By the names of stages.
using Foresight = std::map<std::string, Foreseen>;

/// Stage, seconds, and megabytes where the process had not taken as many before (nothing where none
/// are known), in parentheses those foreseen of a rank, what; where anything was timed, the total.
void print_stages(const std::vector<StageTable> &tables, const Foresight &foreseen);

} // namespace rbvi
