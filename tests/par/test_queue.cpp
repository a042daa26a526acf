// The queue of numbers that groups of ranks share.
#include "rbvi/par/collective.hpp"
#include "rbvi/par/queue.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace rbvi::queue_test {
namespace {

using Clock = std::chrono::steady_clock; // one for all processes of a machine
using Seconds = std::chrono::duration<double>;

const MPI_Comm world = MPI_COMM_WORLD;

/// `test` for every size of groups. Collective.
template <class Test> void for_all_groups(Test &&test) {
  for (int size = 1; size <= ranks_of(world); ++size)
    if (ranks_of(world) % size == 0) test(Groups(world, size));
}

TEST(SharedQueue, GivesOutEveryNumberOnce) {
  for_all_groups([](const Groups &groups) {
    for (const int count : {0, 1, 2, 7, 100, 1000}) {
      SharedQueue queue(world, groups, count);
      std::vector<PetscInt> taken(count, 0);
      while (const std::optional<int> number = queue.next()) {
        std::vector<PetscInt> lowest{*number}, highest{*number};
        over_ranks(groups.comm(), MPI_MIN, lowest);
        over_ranks(groups.comm(), MPI_MAX, highest);
        ASSERT_EQ(lowest, highest) << "one number for all ranks of a group";
        if (groups.leads()) ++taken.at(*number);
        queue.finish(*number % 7 != 0);
      }
      over_ranks(world, MPI_SUM, taken);
      EXPECT_EQ(taken, std::vector<PetscInt>(taken.size(), 1));
      EXPECT_EQ(queue.next(), std::nullopt);
      EXPECT_EQ(queue.state().done, count);
      EXPECT_EQ(queue.solved_here(), rank_of(world) == 0 ? count - (count + 6) / 7 : 0);
      EXPECT_TRUE(queue.state().running.empty());
      EXPECT_FALSE(queue.state().stopped);
    }
  });
}

/// One group after the other asks twice: its second number is behind its first, and the next group
/// begins where the run ends.
TEST(SharedQueue, RunsOfNeighboursShrinkWithWhatIsLeft) {
  for_all_groups([](const Groups &groups) {
    SharedQueue queue(world, groups, 120);
    int begin = 0;
    for (int turn = 0; turn < groups.count(); ++turn) {
      if (groups.mine() == turn) {
        EXPECT_EQ(queue.next(), begin);
        queue.finish();
        EXPECT_EQ(queue.next(), begin + 1);
        queue.finish();
      }
      MPI_Barrier(world);
      begin += (120 - begin) / (2 * groups.count());
    }
  });
}

/// Its numbers in hand stay with it, all others go to groups that ask, at once.
TEST(SharedQueue, NoGroupWaitsForTheFirstRank) {
  const Groups groups(world, 1);
  if (groups.count() == 1) return;
  constexpr int count = 200;
  SharedQueue queue(world, groups, count);
  std::vector<PetscInt> others{0};
  if (rank_of(world) == 0) {
    EXPECT_EQ(queue.next(), 0);
  }
  MPI_Barrier(world);
  const auto start = Clock::now();
  if (rank_of(world) == 0) {
    std::this_thread::sleep_for(std::chrono::seconds(2)); // a long piece of work, without MPI
    queue.finish();
  } else {
    for (; queue.next(); ++others[0])
      queue.finish();
    EXPECT_LE(Seconds(Clock::now() - start).count(), 1);
  }
  over_ranks(world, MPI_SUM, others);
  EXPECT_EQ(others[0], count - count / (2 * groups.count()));
  EXPECT_EQ(queue.state().done, others[0] + 1);
}

TEST(SharedQueue, TellsHowFarAllAre) {
  for_all_groups([](const Groups &groups) {
    SharedQueue queue(world, groups, 4 * groups.count());
    ASSERT_TRUE(queue.next());
    MPI_Barrier(world);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const QueueState before = queue.state();
    MPI_Barrier(world);
    EXPECT_EQ(before.done, 0);
    EXPECT_EQ(before.seconds, 0);
    ASSERT_EQ(std::ssize(before.running), groups.count());
    for (const double elapsed : before.running)
      EXPECT_GE(elapsed, 0.02);
    queue.finish();
    MPI_Barrier(world);
    const QueueState after = queue.state();
    EXPECT_EQ(after.done, groups.count());
    EXPECT_GE(after.seconds, 0.02 * groups.count());
    EXPECT_TRUE(after.running.empty());
  });
}

/// What a group does that fails: nobody gets another number, not even of a run in hand.
TEST(SharedQueue, OneGroupStopsAll) {
  for_all_groups([](const Groups &groups) {
    for (int culprit = 0; culprit < groups.count(); ++culprit) {
      SharedQueue queue(world, groups, 100);
      EXPECT_TRUE(queue.next());
      MPI_Barrier(world);
      if (groups.mine() == culprit) queue.stop();
      MPI_Barrier(world);
      EXPECT_EQ(queue.next(), std::nullopt);
      EXPECT_TRUE(queue.state().stopped);
    }
  });
}

TEST(SecondsLeft, EqualPiecesAreSharedAmongGroups) {
  EXPECT_EQ(seconds_left({0, 0, {0.3}, false}, 10, 1), 0) << "nothing is known";
  EXPECT_DOUBLE_EQ(seconds_left({4, 8, {0}, false}, 10, 1), 12);
  EXPECT_DOUBLE_EQ(seconds_left({10, 10, {0.5, 0.5}, false}, 20, 2), 4.5);
  EXPECT_EQ(seconds_left({20, 10, {}, false}, 20, 2), 0);
}

/// Four groups cannot share the last number.
TEST(SecondsLeft, TheLastNumbersKeepOneGroupEach) {
  EXPECT_DOUBLE_EQ(seconds_left({19, 19, {0.25}, false}, 20, 4), 0.75);
  EXPECT_DOUBLE_EQ(seconds_left({18, 18, {0.9, 0.25}, false}, 20, 4), 0.75);
  EXPECT_DOUBLE_EQ(seconds_left({19, 19, {}, false}, 20, 4), 1) << "not yet begun";
}

} // namespace
} // namespace rbvi::queue_test
