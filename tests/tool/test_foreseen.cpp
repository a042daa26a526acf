// What stages will take, against what they took; runs that do not fit are refused.
#include "../core/refuses.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/mor/reduction.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/tool/offline_run.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

namespace rbvi::foreseen_test {
namespace {

namespace fs = std::filesystem;

struct Run {
  std::string scene;
  SceneOptions choices;
  int refine;
  std::string train;
};

struct Foreseeing : testing::TestWithParam<Run> {
  const MPI_Comm world = PETSC_COMM_WORLD;
  const Groups groups{world, 1};
  ToolOptions options;
  void SetUp() override {
    int id = static_cast<int>(::getpid());
    MPI_Bcast(&id, 1, MPI_INT, 0, world);
    options.out = fs::path(testing::TempDir()) / ("rbvi_foreseen_" + std::to_string(id));
    options.scene = make_scene(GetParam().scene, GetParam().choices);
    options.mesh.refine = GetParam().refine;
    options.train = GetParam().train;
  }
  void TearDown() override {
    MPI_Barrier(world);
    if (rank_of(world) == 0) fs::remove_all(options.out);
  }
  OfflinePlan plan() const {
    return plan_offline(world, groups, options, checked_training(options));
  }
};

TEST_P(Foreseeing, ItIsWhatTheStagesTake) {
  constexpr double base = 30e6; // bytes: allocators keep what one stage has used for others
  measure_costs();
  double before = resident_bytes();
  MPI_Allreduce(MPI_IN_PLACE, &before, 1, MPI_DOUBLE, MPI_MAX, world);
  OfflinePlan planned = plan();
  const Foresight foreseen = planned.foreseen;
  const OfflineRun run =
      run_offline(world, groups, options, checked_training(options), std::move(planned));
  int compared = 0;
  for (const StageTable &table : run.stages)
    for (const StageRow &row : table) {
      if (!row.cost) continue;
      const double took = costs_over_ranks(world, *row.cost).largest.memory - before;
      const double expected = foreseen.at(row.stage.text).first - before;
      EXPECT_GE(expected, took / 2 - base) << row.stage.text;
      EXPECT_LE(expected, 3 * took + base) << row.stage.text;
      EXPECT_LE(row.peak, took + before + 1) << row.stage.text;
      ++compared;
    }
  EXPECT_GE(compared, 6);
  const double seconds = foreseen.at("snapshots").seconds;
  EXPECT_GT(seconds, 0);
}

TEST_P(Foreseeing, ARunThatDoesNotFitIsRefusedBeforeAnythingIsWritten) {
  OfflinePlan planned = plan();
  double most = 0;
  std::string stage;
  for (const StageTable &table : planned.stages)
    for (const StageRow &row : table)
      if (const auto found = planned.foreseen.find(row.stage.text);
          found != planned.foreseen.end() && row.kind != StageKind::skipped &&
          found->second.first > most) {
        most = found->second.first;
        stage = row.stage.text;
      }
  planned.room = {1, 0.51 * most};
  EXPECT_NO_THROW(check_memory(planned.foreseen, planned.stages, planned.room));
  planned.room = {1, 0.49 * most};
  EXPECT_TRUE(refuses(
      "the stage '" + stage + "' would take about " + bytes_text(most) +
          " for the 1 rank of a node, where " + bytes_text(0.49 * most) + " can be had: use ",
      [&] { run_offline(world, groups, options, checked_training(options), std::move(planned)); }));
  MPI_Barrier(world);
  EXPECT_FALSE(fs::exists(options.out));
}

INSTANTIATE_TEST_SUITE_P(
    Cases, Foreseeing,
    testing::Values(Run{"rigid_disk", {}, 1, "random:10:1"},
                    Run{"rigid_disk", {{"formulation", "nitsche"}}, 0, "grid:5"},
                    Run{"membrane_obstacle", {{"circle_edges", "72"}}, 0, "grid:2,2,2"},
                    Run{"two_disks", {}, 1, "4"}, Run{"patch", {}, 2, "5"}),
    [](const auto &of) {
      const SceneOptions &choices = of.param.choices;
      return of.param.scene + (choices.contains("formulation") ? "_nitsche" : "");
    });

/// Ranks of a node share its memory.
TEST(Memory, OfAllRanksOfANode) {
  const std::vector<StageTable> stages{{{stage::pod, "modes"}}};
  const Foresight foreseen{{stage::pod.text, {5e8, 3e8, 0, fewer_samples}},
                           {stage::cone.text, {9e9, 9e9}}};
  EXPECT_NO_THROW(check_memory(foreseen, stages, {3, 0.6e9}));
  EXPECT_NE(memory_text(foreseen, stages, {3, 0.6e9})
                .find("it may not fit; smaller by fewer samples (-train)"),
            std::string::npos);
  EXPECT_TRUE(refuses("the stage 'POD' would take about 1.1 GB for the 3 ranks of a node, where "
                      "500 MB can be had: use fewer samples (-train)",
                      [&] {
                        check_memory(foreseen, stages, {3, 0.5e9});
                      }));
  EXPECT_EQ(memory_text(foreseen, stages, {1, 1e9}),
            "The most memory that a stage takes is about 500 MB for the 1 rank of a node (POD), of "
            "1 GB");
}

} // namespace
} // namespace rbvi::foreseen_test
