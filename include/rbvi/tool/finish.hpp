// How the rbvi tool starts and ends: its command line, and one error line for all ranks.
#pragma once

#include <mpi.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rbvi {

/// The command line: command, its file (inspect) or scene (help), and what PETSc is to see.
struct Invocation {
  std::string command, file;
  /// help: the command that is asked about, or help itself: in short; new: the mesh; compare: -csv
  std::string topic;
  std::vector<std::string> files{};           ///< compare: run folders, model files
  bool json = false;                          ///< help: as JSON
  mutable std::vector<std::string> arguments; ///< program name and options, dashes normalised
  std::optional<int> status;                  ///< set: nothing to run, exit with this
  std::string message;                        ///< printed then
  std::vector<char *> pointers() const;       ///< argv for PETSc, null-terminated
};

/// Reads the command; -version, -help and mistakes of the command itself need no PETSc.
Invocation read_invocation(int argc, char **argv);

/// Prints a message once for all ranks (to standard error unless the status is 0), ends MPI and
/// returns the status. Starts MPI itself: for what is known before PETSc runs. Collective.
int report_once(int status, const std::string &message);

/// Runs `work` on every rank and returns the exit status. A failure that all ranks share is printed
/// once; one that leaves other ranks waiting ends them all after a moment (MPI_Abort).
int finish(MPI_Comm world, const std::function<void()> &work);

} // namespace rbvi
