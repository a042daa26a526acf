#include "rbvi/par/queue.hpp"

#include "rbvi/par/collective.hpp"

#include <algorithm>
#include <atomic>

namespace rbvi {

namespace {

/// Words of the window. Behind them, for each group, when it began with its number in nanoseconds
/// plus one, zero where it has none.
enum Word : MPI_Aint { runs_taken, stopped, done, failed, nanoseconds, began };

/// Sums, replacements and MPI_NO_OP: compare-and-swap by osc/rdma of Open MPI 4.1.4 crashes where a
/// rank addresses itself in shared memory.
std::int64_t fetch_and(MPI_Op op, std::int64_t value, MPI_Aint word, MPI_Win window) {
  std::int64_t before = 0;
  MPI_Fetch_and_op(&value, &before, MPI_INT64_T, 0, word, op, window);
  MPI_Win_flush(0, window);
  return before;
}

/// The k-th that asks gets the k-th run: how long it is follows from what those before it left.
std::vector<int> guided_runs(int count, int groups) {
  std::vector<int> begins{0};
  while (begins.back() < count)
    begins.push_back(begins.back() + std::max(1, (count - begins.back()) / (2 * groups)));
  return begins;
}

} // namespace

SharedQueue::SharedQueue(MPI_Comm world, const Groups &groups, int count)
    : groups_(groups), count_(count), runs_(guided_runs(count, groups.count())) {
  const int words = rank_of(world) == 0 ? static_cast<int>(began) + groups.count() : 0;
  constexpr int size = sizeof(std::int64_t);
  MPI_Win_allocate(words * size, size, MPI_INFO_NULL, world, &words_, &window_);
  if (words == 0) words_ = nullptr;
  MPI_Win_lock_all(MPI_MODE_NOCHECK, window_);
  std::fill_n(words_, words, 0);
  MPI_Win_sync(window_);
  MPI_Barrier(world);
  start_ = MPI_Wtime();
}

SharedQueue::~SharedQueue() {
  MPI_Win_unlock_all(window_);
  MPI_Win_free(&window_);
}

std::int64_t SharedQueue::now() const {
  return static_cast<std::int64_t>((MPI_Wtime() - start_) * 1e9);
}

/// The next number, -1 for none, by the first rank of the group.
int SharedQueue::take() {
  if (fetch_and(MPI_NO_OP, 0, stopped, window_) != 0) return -1;
  if (first_ == end_) {
    const std::int64_t run = fetch_and(MPI_SUM, 1, runs_taken, window_);
    if (run + 1 >= std::ssize(runs_)) return -1;
    first_ = runs_[run];
    end_ = runs_[static_cast<std::size_t>(run) + 1];
  }
  began_ = now();
  fetch_and(MPI_REPLACE, began_ + 1, began + groups_.mine(), window_);
  return first_++;
}

std::optional<int> SharedQueue::next() {
  int number = groups_.leads() ? take() : 0;
  MPI_Bcast(&number, 1, MPI_INT, 0, groups_.comm());
  if (number < 0) return std::nullopt;
  return number;
}

void SharedQueue::finish(bool solved) {
  if (!groups_.leads()) return;
  if (!solved) fetch_and(MPI_SUM, 1, failed, window_); // first: at no time too many are solved
  fetch_and(MPI_REPLACE, 0, began + groups_.mine(), window_);
  fetch_and(MPI_SUM, now() - began_, nanoseconds, window_);
  fetch_and(MPI_SUM, 1, done, window_);
}

void SharedQueue::stop() {
  fetch_and(MPI_SUM, 1, stopped, window_);
}

QueueState SharedQueue::state() const {
  std::vector<std::int64_t> words(began + groups_.count());
  const int count = static_cast<int>(words.size()) - 1; // all but the first
  MPI_Get_accumulate(nullptr, 0, MPI_INT64_T, words.data() + stopped, count, MPI_INT64_T, 0,
                     stopped, count, MPI_INT64_T, MPI_NO_OP, window_);
  MPI_Win_flush(0, window_);
  QueueState state;
  state.stopped = words[stopped] != 0;
  state.done = static_cast<int>(words[done]);
  state.seconds = 1e-9 * static_cast<double>(words[nanoseconds]);
  const std::int64_t time = now();
  for (auto word = words.begin() + began; word != words.end(); ++word)
    if (*word != 0)
      state.running.push_back(1e-9 * static_cast<double>(std::max<std::int64_t>(0, time - *word)));
  return state;
}

int SharedQueue::solved_here() const {
  if (words_ == nullptr) return 0;
  const std::int64_t finished = std::atomic_ref(words_[done]).load(); // before those that failed
  return static_cast<int>(finished - std::atomic_ref(words_[failed]).load());
}

double seconds_left(const QueueState &state, int count, int groups) {
  if (state.done == 0 || state.done >= count) return 0;
  const double mean = state.seconds / state.done;
  const int rest = count - state.done;
  const int running = std::min(static_cast<int>(state.running.size()), rest);
  double work = mean * (rest - running), longest = 0;
  for (const double elapsed : state.running) {
    const double left = std::max(0.0, mean - elapsed);
    work += left;
    longest = std::max(longest, left);
  }
  return std::max(longest, work / std::min(groups, rest));
}

} // namespace rbvi
