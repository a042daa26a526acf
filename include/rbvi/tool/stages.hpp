// The stages of an offline run as one table: before the run what will be done, after it what was
// done and how long it took, and in both what is skipped and why.
#pragma once

#include "rbvi/tool/options/options.hpp"

namespace rbvi {

struct StageRow {
  std::string stage; ///< as in StageTimes
  std::string what;  ///< what is done, or why not
  bool skipped = false;
};

/// What a run knows at its end.
struct OfflineResult {
  const SweepReport &sweep;
  const Reduction &made;
};

/// One row per stage, in the order of the run. `result` null: as planned; what hangs on the
/// separation of the operators is then said as a condition.
std::vector<StageRow> offline_stages(const ToolOptions &options, std::size_t training, int groups,
                                     const OfflineResult *result = nullptr);

/// Stage, seconds (nothing where no time is known) or "skipped", what.
void print_stages(const std::vector<StageRow> &rows, const StageTimes &times);

} // namespace rbvi
