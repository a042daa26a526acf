#include "rbvi/par/interrupt.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/io/write_atomically.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <mutex>
#include <unistd.h>

namespace rbvi {

namespace {

// A handler may do next to nothing: it hands the signal to a thread, which may do everything.
int to_thread = -1, from_handler = -1;
volatile std::sig_atomic_t received = 0;

std::mutex text_mutex;
std::function<std::string()> text_of_progress;

void handle(int signal) {
  if (received != 0) _exit(128 + signal);
  received = 1;
  const int before = errno;
  const auto byte = static_cast<unsigned char>(signal);
  if (::write(to_thread, &byte, 1) != 1) _exit(128 + signal);
  errno = before;
}

std::string progress() {
  const std::lock_guard<std::mutex> lock(text_mutex);
  try {
    return text_of_progress ? text_of_progress() : "";
  } catch (const std::exception &) {
    return "";
  }
}

void say(const std::string &line) {
  const std::string text = (isatty(STDERR_FILENO) == 1 ? "\n" : "") + line + "\n";
  if (::write(STDERR_FILENO, text.data(), text.size()) < 0) return;
}

/// Waits for a signal; ends when the other end of the pipe is closed.
void wait_for_signal(bool speaks) {
  unsigned char signal = 0;
  ssize_t count = 0;
  do
    count = ::read(from_handler, &signal, 1);
  while (count < 0 && errno == EINTR);
  if (count != 1) return;
  // mpirun kills after a second: the line does not wait for a slow disk, nor for a file that is
  // being written.
  (void)stop_writing(std::chrono::milliseconds(0));
  if (speaks) {
    say("rbvi: interrupted" + progress());
    // What a rank says last, mpirun loses at times unless the rank is still there when it is read.
    if (isatty(STDERR_FILENO) == 0) std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
  (void)stop_writing(std::chrono::milliseconds(600));
  _exit(128 + signal);
}

} // namespace

void say_when_interrupted(std::function<std::string()> text) {
  const std::lock_guard<std::mutex> lock(text_mutex);
  text_of_progress = std::move(text);
}

InterruptWatch::InterruptWatch() : watched_{{{SIGINT, {}}, {SIGTERM, {}}, {SIGHUP, {}}}} {
  for (Watched &watched : watched_)
    ::sigaction(watched.signal, nullptr, &watched.before);
}

void InterruptWatch::start(bool speaks) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    throw failure(std::string("cannot watch for signals: ") + std::strerror(errno));
  from_handler = ends[0];
  to_thread = ends[1];
  received = 0;
  thread_ = std::thread(wait_for_signal, speaks);
  for (const Watched &watched : watched_) {
    struct sigaction action {};
    action.sa_handler = watched.before.sa_handler == SIG_IGN ? SIG_IGN : handle;
    ::sigaction(watched.signal, &action, nullptr);
  }
}

void InterruptWatch::stop() {
  if (!thread_.joinable()) return;
  for (const Watched &watched : watched_)
    ::sigaction(watched.signal, &watched.before, nullptr);
  ::close(to_thread);
  thread_.join();
  ::close(from_handler);
}

} // namespace rbvi
