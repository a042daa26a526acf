// Tables of the growth of cost with the mesh.
#include "rbvi/tool/growth.hpp"

#include "rbvi/core/parameters.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

namespace rbvi::growth_test {
namespace {

TEST(Growth, TheExponentOfAPowerLaw) {
  const std::vector<double> dofs{100, 400, 1600};
  std::vector<double> seconds;
  for (const double n : dofs)
    seconds.push_back(3 * std::pow(n, 1.5));
  EXPECT_NEAR(growth_exponent(dofs, seconds).value(), 1.5, 1e-12);
  seconds[1] *= 1.3; // the middle one of three has no say
  EXPECT_NEAR(growth_exponent(dofs, seconds).value(), 1.5, 1e-12);
}

TEST(Growth, NoExponentWithoutTwoMeshes) {
  EXPECT_FALSE(growth_exponent({100}, {1}));
  EXPECT_FALSE(growth_exponent({100, 100}, {1, 2}));
  EXPECT_FALSE(growth_exponent({100, 400}, {0, 2})) << "zero has no logarithm";
  EXPECT_FALSE(growth_exponent({}, {}));
}

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

TEST(Growth, APageHasATableForEachNumberOfRanksPerSolve) {
  const std::string page = growth_page({run_on(0, 1), run_on(1, 1), run_on(0, 2), run_on(1, 2)});
  EXPECT_NE(page.find("## 1 rank per solve"), std::string::npos) << page;
  EXPECT_NE(page.find("## 2 ranks per solve"), std::string::npos) << page;
  const std::size_t at = page.find("| snapshots |");
  ASSERT_NE(at, std::string::npos) << page;
  const std::string row = page.substr(at, page.find('\n', at) - at);
  EXPECT_NE(row.find("| 1.25 |"), std::string::npos) << "seconds: " << row;
  EXPECT_NE(row.find("| 1.00 |"), std::string::npos) << "memory above the resident: " << row;
  EXPECT_NE(row.find("| 7 / 7 |"), std::string::npos) << "factorisations: " << row;
}

TEST(Growth, AStageThatDidNotRunOnAMeshHasNoNumberThere) {
  GrowthRun fine = run_on(1, 1);
  fine.stages.pop_back();
  const std::string page = growth_page({run_on(0, 1), fine});
  EXPECT_NE(page.find("| 7 / - |"), std::string::npos) << page;
}

} // namespace
} // namespace rbvi::growth_test
