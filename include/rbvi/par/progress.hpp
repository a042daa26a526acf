// Progress of a loop: one updating line on a terminal, plain lines now and then otherwise.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>

namespace rbvi {

class Progress {
public:
  /// `what`: "samples"; `total` steps in all, 0 where nobody knows; a rank that does not report
  /// stays silent.
  Progress(std::string what, int total, bool reports);
  ~Progress(); ///< ends the line
  Progress(const Progress &) = delete;
  Progress &operator=(const Progress &) = delete;
  /// Whether it is time for a line: what it says need not be found out before.
  bool due() const;
  /// `done` of the total are finished, the others take `left` seconds; `detail` ("0.1 s each, ")
  /// stands before the times.
  void update(int done, double left, const std::string &detail = "");
  /// The same where each step takes as long.
  void update(int done);

private:
  std::string what_;
  int total_;
  bool reports_, terminal_;
  std::chrono::steady_clock::time_point start_, last_;
};

/// From now on lines of progress that are updated go there, if that is a terminal, behind `before`,
/// which is left at their end; plain lines go to standard output as ever. By default to standard
/// output, behind nothing.
void show_progress_on(std::FILE *terminal, const std::string &before);

} // namespace rbvi
