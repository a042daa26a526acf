// How a process ends that is told to: SIGINT (Ctrl-C), SIGTERM (mpirun, a batch system) or SIGHUP
// (the terminal is closed).
#pragma once

#include <array>
#include <csignal>
#include <functional>
#include <string>
#include <thread>

namespace rbvi {

/// From start() to stop(), these signals end the process at once with status 128 + signal, in
/// whatever it is: a file that is being written comes to its name first, and one rank says in one
/// line how far the work came. A second signal does not even wait for that. Open MPI's mpirun hands
/// all of them on as SIGTERM, kills what is left after a second, and returns 1.
class InterruptWatch {
public:
  /// Notes which of the signals are ignored (nohup, the background of a script): they stay so.
  InterruptWatch();
  /// Takes over from PETSc, which must have started. `speaks`: this rank is the one that says it.
  void start(bool speaks);
  /// To be called before MPI ends: mpirun may then end a rank that another one is ahead of.
  void stop();
  ~InterruptWatch() { stop(); }
  InterruptWatch(const InterruptWatch &) = delete;
  InterruptWatch &operator=(const InterruptWatch &) = delete;

private:
  struct Watched {
    int signal;
    struct sigaction before;
  };
  std::array<Watched, 3> watched_;
  std::thread thread_;
};

/// What the line says after "interrupted" from now on: " after 17 of 125 samples: ...". `text` runs
/// in another thread, without MPI and PETSc.
void say_when_interrupted(std::function<std::string()> text);

} // namespace rbvi
