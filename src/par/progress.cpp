#include "rbvi/par/progress.hpp"

#include "rbvi/core/text.hpp"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

namespace rbvi {

namespace {
using Seconds = std::chrono::duration<double>;
constexpr Seconds between_lines{5}, between_updates{0.1};

/// Where lines go, and what stands before them on a terminal.
struct Line {
  std::FILE *to;
  std::string before;
};

Line &line() {
  static Line own{stdout, ""};
  return own;
}

/// Open MPI gives its processes terminals of their own: what counts is where mpirun writes to.
bool writes_to_terminal() {
  if (isatty(fileno(line().to)) != 1) return false;
  if (std::getenv("OMPI_COMM_WORLD_SIZE") == nullptr) return true;
  std::error_code error;
  const auto target =
      std::filesystem::read_symlink("/proc/" + std::to_string(getppid()) + "/fd/1", error).string();
  return !error && (target.starts_with("/dev/pts/") || target.starts_with("/dev/tty"));
}
} // namespace

void show_progress_on(std::FILE *terminal, const std::string &before) {
  line() = {terminal, before};
}

Progress::Progress(std::string what, int total, bool reports)
    : what_(std::move(what)), total_(total), reports_(reports),
      terminal_(reports && writes_to_terminal()), start_(std::chrono::steady_clock::now()),
      last_(start_) {}

Progress::~Progress() {
  if (!terminal_ || last_ == start_) return;
  if (line().before.empty())
    std::fprintf(line().to, "\n");
  else // what comes next stands on the same line
    std::fprintf(line().to, "\r%s\x1b[K", line().before.c_str());
  std::fflush(line().to);
}

bool Progress::due() const {
  const auto passed = std::chrono::steady_clock::now() - last_;
  return reports_ && passed >= (terminal_ ? between_updates : between_lines);
}

void Progress::update(int done, double left, const std::string &detail) {
  if (!reports_ || done == 0 || (!due() && (total_ == 0 || done < total_))) return;
  last_ = std::chrono::steady_clock::now();
  const double elapsed = Seconds(last_ - start_).count();
  const std::string of = total_ > 0 ? " of " + std::to_string(total_) : "",
                    rest = total_ > 0 ? formatted(", %.1f s left", left) : "";
  std::FILE *to = terminal_ ? line().to : stdout;
  std::fprintf(to, "%s  %d%s %s, %s%.1f s%s%s", terminal_ ? ("\r" + line().before).c_str() : "",
               done, of.c_str(), what_.c_str(), detail.c_str(), elapsed, rest.c_str(),
               terminal_ ? "\x1b[K" : "\n");
  std::fflush(to);
}

void Progress::update(int done) {
  const double elapsed = Seconds(std::chrono::steady_clock::now() - start_).count();
  if (done > 0) update(done, elapsed / done * (total_ - done));
}

} // namespace rbvi
