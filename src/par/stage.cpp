#include "rbvi/par/stage.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/par/petsc.hpp"

#include <algorithm>
#include <string_view>

namespace rbvi {

namespace {

bool runs(const StageRow &row) {
  return row.kind == StageKind::runs || row.kind == StageKind::nothing_to_do;
}

template <class Table> auto find_running(Table &table, StageName stage) {
  return std::find_if(table.begin(), table.end(), [&](const StageRow &row) {
    return runs(row) && std::string_view(row.stage.text) == stage.text;
  });
}

} // namespace

bool will_run(const StageTable &table, StageName stage) {
  return find_running(table, stage) != table.end();
}

Stage::Stage(StageTable &table, StageName stage) : start_(MPI_Wtime()) {
  const auto row = find_running(table, stage);
  if (row == table.end())
    throw failure(std::string("the stage '") + stage.text + "' runs, but was not declared to");
  row_ = &*row;
  PetscLogStage log = -1;
  RBVI_CALL(PetscLogStageGetId(stage.text, &log));
  if (log < 0) RBVI_CALL(PetscLogStageRegister(stage.text, &log));
  RBVI_CALL(PetscLogStagePush(log));
  if (costs_are_measured()) meter_.emplace();
  peak_ = peak_bytes();
}

Stage::~Stage() {
  if (const double peak = peak_bytes(); peak > peak_) row_->peak = std::max(row_->peak, peak);
  if (meter_) row_->cost = row_->cost.value_or(StageCost()) + meter_->so_far();
  (void)PetscLogStagePop();
  row_->seconds = row_->seconds.value_or(0) + MPI_Wtime() - start_;
}

StageTable finished_stages(const StageTable &ran, StageTable told) {
  const auto same_stage = [](const StageRow &a, const StageRow &b) {
    return std::string_view(a.stage.text) == b.stage.text;
  };
  if (!std::equal(ran.begin(), ran.end(), told.begin(), told.end(), same_stage))
    throw failure("the stages that are told are not those that were declared");
  for (std::size_t i = 0; i < told.size(); ++i) {
    told[i].seconds = ran[i].seconds;
    told[i].cost = ran[i].cost;
    told[i].peak = ran[i].peak;
    if (runs(told[i]) && !told[i].seconds)
      throw failure(std::string("the stage '") + told[i].stage.text +
                    "' was declared to run, but did not");
  }
  return told;
}

} // namespace rbvi
