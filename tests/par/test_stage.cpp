#include "rbvi/core/error.hpp"
#include "rbvi/par/stage.hpp"

#include <gtest/gtest.h>

namespace rbvi::stage_test {
namespace {

constexpr StageName first("first"), second("second"), third("third");

StageTable plan() {
  return {{first, "to do"}, {second, "not wanted", StageKind::skipped}, {third, "to do"}};
}

TEST(Stages, ARunIsTimedIntoItsRowAndRunsAddUp) {
  StageTable table = plan();
  EXPECT_TRUE(will_run(table, first));
  EXPECT_FALSE(will_run(table, second));
  EXPECT_EQ(timed(table, first, [] { return 7; }), 7);
  const double once = table[0].seconds.value();
  timed(table, first, [] {});
  EXPECT_GE(table[0].seconds.value(), once);
  EXPECT_FALSE(table[2].seconds);
}

TEST(Stages, WhatWasNotDeclaredToRunDoesNotRun) {
  StageTable table = plan();
  EXPECT_THROW(Stage(table, second), Error);
  EXPECT_THROW(Stage(table, StageName("fourth")), Error);
}

TEST(Stages, WhatWasDeclaredToRunMustHaveRun) {
  StageTable table = plan(), told = plan();
  told[0].what = "done";
  timed(table, first, [] {});
  EXPECT_THROW(finished_stages(table, told), Error);
  EXPECT_THROW(finished_stages({table[0], table[1]}, told), Error);
  timed(table, third, [] {});
  const StageTable finished = finished_stages(table, told);
  EXPECT_EQ(finished[0].what, "done");
  EXPECT_EQ(finished[0].seconds, table[0].seconds);
  EXPECT_FALSE(finished[1].seconds);
}

} // namespace
} // namespace rbvi::stage_test
