// Numbers 0 .. count - 1 of independent pieces of work, given out to groups of ranks as these ask
// for them, so that no group waits while there is work: a sweep takes its samples from here.
//
// A group takes runs of consecutive numbers, remaining / (2 groups) of them and at least one
// (guided self-scheduling): neighbours stay together as long as there are many, and in the end all
// groups finish within about one piece of work of each other.
//
// What is assumed of MPI: the counters are words in a window of the first rank (passive target),
// and only MPI's atomic operations touch them, on each word one kind of them beside MPI_NO_OP. That
// they go on while the first rank computes without calling MPI is up to the library. Open MPI 4.1
// does so on one node by its components osc/rdma, which it takes there, and osc/sm: a test waits
// for it. Between nodes that needs a network with remote atomics. With osc/pt2pt (plain TCP) a
// group waits until the first rank calls MPI next, at the latest when it asks for its own next
// number: slower, but nothing is lost and nothing hangs.
#pragma once

#include "rbvi/par/groups.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace rbvi {

/// How far all groups are together.
struct QueueState {
  int done = 0;       ///< numbers that are finished
  double seconds = 0; ///< that they took, summed up over them
  /// For each group that works on a number: seconds since it began with it.
  std::vector<double> running;
  bool stopped = false;
};

class SharedQueue {
public:
  /// Collective on `world`, whose groups these are; they must outlive the queue.
  SharedQueue(MPI_Comm world, const Groups &groups, int count);
  /// Collective on `world`.
  ~SharedQueue();
  SharedQueue(const SharedQueue &) = delete;
  SharedQueue &operator=(const SharedQueue &) = delete;

  /// The next number for this group; none when all are given out, or some group has stopped.
  /// Collective on the group.
  std::optional<int> next();
  /// The number that this group has is finished; not `solved`: without a result.
  void finish(bool solved = true);
  /// No group gets another number: for a group that leaves by an exception. One call of the first
  /// rank of a group is enough.
  void stop();
  QueueState state() const;
  /// Numbers that are finished with a result, as the memory of the first rank has it; zero on the
  /// others. Without MPI, from any thread.
  int solved_here() const;
  int count() const { return count_; }

private:
  int take();
  std::int64_t now() const;

  const Groups &groups_;
  int count_;
  MPI_Win window_ = MPI_WIN_NULL;
  std::int64_t *words_ = nullptr; ///< of the window, on the first rank of the world
  double start_ = 0;              ///< MPI_Wtime when all groups were there
  std::vector<int> runs_;         ///< where each run begins; behind them the count
  int first_ = 0, end_ = 0;       ///< what is left of the run of this group
  std::int64_t began_ = 0;        ///< with its number, nanoseconds
};

/// Seconds until all of `count` numbers are finished, by the mean of those that are; groups work
/// side by side, and the last numbers keep one group each busy. Zero before one is finished.
double seconds_left(const QueueState &state, int count, int groups);

} // namespace rbvi
