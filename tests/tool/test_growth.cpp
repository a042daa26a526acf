// Tables of the growth of cost with the mesh.
#include "rbvi/tool/growth.hpp"

#include "rbvi/core/parameters.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

namespace rbvi::growth_test {
namespace {

/// Work like dofs^1.25, memory like dofs above what is resident.
GrowthRun run_on(int refine, int ranks_per_solve) {
  GrowthRun run;
  run.scene = "membrane";
  run.refine = refine;
  run.ranks = 2;
  run.ranks_per_solve = ranks_per_solve;
  run.dofs = 1000 << (2 * refine);
  run.resident = 50e6;
  StageCost mesh, snapshots;
  mesh.seconds = 1;
  mesh.memory = run.resident + 2000.0 * run.dofs;
  snapshots.seconds = std::pow(run.dofs, 1.25);
  snapshots.memory = run.resident + 1000.0 * run.dofs;
  snapshots.factorisations = 7;
  run.stages = {{"mesh", {mesh, mesh}}, {"snapshots", {snapshots, snapshots}}};
  return run;
}

TEST(Growth, StagesAddUpButTheirMemory) {
  const RankCosts total = total_cost(run_on(0, 1));
  EXPECT_DOUBLE_EQ(total.largest.seconds, 1 + std::pow(1000, 1.25));
  EXPECT_EQ(total.largest.factorisations, 7);
  EXPECT_EQ(total.largest.memory, 52e6);
}

TEST(Growth, ATableHasARowForEachStageAndRun) {
  std::istringstream lines(growth_csv({run_on(0, 1), run_on(1, 1), run_on(0, 2)}));
  std::string line;
  ASSERT_TRUE(std::getline(lines, line));
  const std::vector<std::string> names = split(line, ',');
  int rows = 0;
  for (; std::getline(lines, line); ++rows)
    EXPECT_EQ(split(line, ',').size(), names.size()) << line;
  EXPECT_EQ(rows, 3 * 3);
}

} // namespace
} // namespace rbvi::growth_test
