// How many ranks share a solve.
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/sweep/grouping.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::grouping_test {
namespace {

const NodeMemory ample{4, 1e15};
const SolveSize small{5000, 2}, large{1e6, 2};

int chosen(int ranks, std::size_t samples, const SolveSize &size, const NodeMemory &node = ample) {
  return choose_grouping(ranks, samples, size, node).ranks_per_solve;
}

TEST(Grouping, ManySamplesAreSolvedSideBySide) {
  for (const SolveSize &size : {small, large})
    for (const int ranks : {1, 2, 3, 4, 6, 64})
      EXPECT_EQ(chosen(ranks, 1000, size), 1) << ranks;
}

TEST(Grouping, NoGroupIsWithoutASample) {
  EXPECT_EQ(chosen(4, 2, small), 2);
  EXPECT_EQ(chosen(4, 3, small), 2);
  EXPECT_EQ(chosen(4, 1, small), 4);
  EXPECT_EQ(chosen(4, 0, small), 4);
  EXPECT_EQ(chosen(3, 2, small), 3);
  EXPECT_EQ(chosen(12, 5, small), 3);
}

/// 5 samples on 4 ranks: two turns of 4 groups, or three turns of 2 that are faster.
TEST(Grouping, RanksShareALargeSolveWhereTurnsAreFewer) {
  EXPECT_GT(solve_speedup(large, 2), 1);
  EXPECT_GT(solve_speedup(large, 4), solve_speedup(large, 2));
  EXPECT_EQ(solve_speedup(small, 4), 1);
  EXPECT_EQ(chosen(4, 9, small), 1);
  for (const std::size_t samples : {4U, 5U, 6U, 7U, 8U, 9U, 20U, 21U}) {
    const auto turns = [&](std::size_t groups) {
      return static_cast<double>((samples + groups - 1) / groups);
    };
    const double apart = turns(4), pairs = turns(2) / solve_speedup(large, 2),
                 together = turns(1) / solve_speedup(large, 4);
    const int best = apart <= pairs && apart <= together ? 1 : pairs <= together ? 2 : 4;
    EXPECT_EQ(chosen(4, samples, large), best) << samples;
  }
}

TEST(Grouping, SolvesSideBySideFitIntoTheMemory) {
  const double bytes = solve_bytes(large);
  EXPECT_GT(bytes, 8 * large.dofs);
  EXPECT_LT(solve_bytes(small), bytes);
  EXPECT_LT(bytes, solve_bytes({large.dofs, 3}));
  EXPECT_EQ(chosen(4, 100, large, {4, 4.1 * bytes}), 1);
  EXPECT_EQ(chosen(4, 100, large, {4, 3.9 * bytes}), 2);
  EXPECT_EQ(chosen(4, 100, large, {4, 1.9 * bytes}), 4);
  EXPECT_EQ(chosen(4, 100, large, {4, 0.1 * bytes}), 4) << "there is no better way";
  EXPECT_EQ(chosen(4, 100, large, {2, 1.1 * bytes}), 2) << "two nodes, one solve on each";
  const std::string text = choose_grouping(4, 100, large, {4, 3.9 * bytes}).text;
  EXPECT_NE(text.find("by 2 groups of 2 ranks: 100 samples of about 1000000 dofs"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("4 solves side by side would not fit"), std::string::npos) << text;
}

TEST(Grouping, EveryNodeTellsItsMemory) {
  const NodeMemory node = tightest_node(PETSC_COMM_WORLD);
  EXPECT_EQ(node.ranks, ranks_of(PETSC_COMM_WORLD)) << "the tests run on one node";
  EXPECT_GT(node.bytes, 1e6);
  EXPECT_TRUE(std::isfinite(node.bytes));
}

/// The default sizes of every scene: each rank its own solves.
TEST(Grouping, DefaultSizesAreSolvedByOneRankEach) {
  for (const SceneEntry &entry : catalogue()) {
    const Scene scene = make_scene(entry.name);
    const std::size_t samples = parse_set(scene.parameters, scene.training).size();
    const Grouping grouping = group_ranks(PETSC_COMM_WORLD, scene, {}, samples, 0);
    EXPECT_EQ(grouping.ranks_per_solve, 1) << entry.name << ": " << grouping.text;
  }
}

TEST(Grouping, ANumberForcesIt) {
  const Grouping grouping =
      group_ranks(PETSC_COMM_WORLD, make_scene("membrane_obstacle"), {}, 1, 1);
  EXPECT_EQ(grouping.ranks_per_solve, 1);
}

} // namespace
} // namespace rbvi::grouping_test
