// The stages of a run: each declared as a row of a table before it runs, then timed into that row,
// and a stage of PETSc's -log_view.
#pragma once

#include "rbvi/par/stage_cost.hpp"

#include <optional>
#include <string>
#include <vector>

namespace rbvi {

/// The name of a stage, as a constant of the code that runs it.
struct StageName {
  explicit constexpr StageName(const char *name) : text(name) {}
  const char *text;
};

enum class StageKind {
  runs,
  nothing_to_do, ///< it runs, and what it is for is there already: printed as skipped
  part,          ///< it is told apart, but runs as a part of other stages
  skipped
};

struct StageRow {
  StageName stage;
  std::string what; ///< what is done, or why not
  StageKind kind = StageKind::runs;
  std::optional<double> seconds = {}; ///< wall seconds of all its runs
  std::optional<StageCost> cost = {}; ///< of all its runs, where costs_are_measured()
  double peak = 0; ///< bytes: largest resident set, where it made that of the process larger
};

/// The declaration of what will run, in the order of print.
using StageTable = std::vector<StageRow>;

/// Whether the table declares that the stage runs.
bool will_run(const StageTable &table, StageName stage);

/// Measures from construction to destruction. Throws failure if the table, which must stay where it
/// is meanwhile, does not declare that the stage runs.
class Stage {
public:
  Stage(StageTable &table, StageName stage);
  ~Stage();
  Stage(const Stage &) = delete;
  Stage &operator=(const Stage &) = delete;

private:
  StageRow *row_;
  double start_, peak_;
  std::optional<CostMeter> meter_;
};

/// What `run` returns, timed as a stage.
template <class Run> auto timed(StageTable &table, StageName stage, Run &&run) {
  const Stage measured(table, stage);
  return run();
}

/// What was done, `told`, with the seconds and costs of the same rows of the plan, `ran`. Throws
/// failure if the rows differ or one that is told as run has not run.
StageTable finished_stages(const StageTable &ran, StageTable told);

} // namespace rbvi
