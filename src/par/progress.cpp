#include "rbvi/par/progress.hpp"

#include <unistd.h>

#include <cstdio>

namespace rbvi {

namespace {
using Seconds = std::chrono::duration<double>;
constexpr Seconds between_lines{5}, between_updates{0.1};
} // namespace

Progress::Progress(std::string what, int total, bool reports)
    : what_(std::move(what)), total_(total), reports_(reports),
      terminal_(isatty(STDOUT_FILENO) == 1), start_(std::chrono::steady_clock::now()),
      last_(start_) {}

void Progress::update(int done, const std::string &detail) {
  if (!reports_ || done == 0) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < (terminal_ ? between_updates : between_lines) && done < total_) return;
  last_ = now;
  const double elapsed = Seconds(now - start_).count();
  const double left = elapsed / done * (total_ - done);
  std::printf("%s  %d of %d %s, %.1f s, %.1f s left%s%s%s", terminal_ ? "\r" : "", done, total_,
              what_.c_str(), elapsed, left, detail.empty() ? "" : ", ", detail.c_str(),
              terminal_ ? "\x1b[K" : "\n");
  std::fflush(stdout);
}

void Progress::finish() {
  if (reports_ && terminal_) std::printf("\n");
}

} // namespace rbvi
