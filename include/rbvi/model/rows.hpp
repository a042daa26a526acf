// Rows of a table, each answered by itself, over threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace rbvi {

inline constexpr std::size_t rows_of_thread = 64; ///< at most, one behind the other

/// How many threads so many rows take: `wanted`, 0: one for each core, but no more than there are
/// blocks of rows; at least one.
inline unsigned threads_for(std::size_t rows, unsigned wanted) {
  if (wanted == 0) wanted = std::max(1U, std::thread::hardware_concurrency());
  const std::size_t blocks = (rows + rows_of_thread - 1) / rows_of_thread;
  return static_cast<unsigned>(std::clamp<std::size_t>(blocks, 1, wanted));
}

/// Calls work(thread, row), which must not throw, once for every row; threads from 0 on, at least
/// one. Blocks of rows go to whichever is free, short ones where there are few.
template <class Work> void over_rows(std::size_t rows, unsigned threads, const Work &work) {
  const std::size_t block = std::clamp<std::size_t>(rows / (16 * threads), 1, rows_of_thread);
  std::atomic<std::size_t> next = 0;
  const auto run = [&](unsigned thread) {
    for (std::size_t first = next.fetch_add(block); first < rows; first = next.fetch_add(block))
      for (std::size_t row = first; row < std::min(first + block, rows); ++row)
        work(thread, row);
  };
  std::vector<std::jthread> others;
  for (unsigned thread = 1; thread < threads; ++thread)
    others.emplace_back(run, thread);
  run(0);
}

} // namespace rbvi
