// Starts and ends PETSc and SLEPc for one process, and keeps their error messages for the one line
// that an rbvi::Error carries.
#pragma once

#include "rbvi/par/petsc.hpp"

#include <optional>

namespace rbvi {

/// While it lives, a failing PETSc call prints no traceback; throw_petsc_error finds the innermost
/// message instead.
class ErrorRecorder {
public:
  ErrorRecorder();
  ~ErrorRecorder();
  ErrorRecorder(const ErrorRecorder &) = delete;
  ErrorRecorder &operator=(const ErrorRecorder &) = delete;

private:
  PetscBool checked_memory_ = PETSC_FALSE; ///< PETSc's allocator in the constructor
};

/// Initialises MPI, PETSc and SLEPc and installs an ErrorRecorder; finalises them at the end of its
/// life, when no Handle may be left. A closed standard output ends the process without a word
/// (SIGPIPE), as it does other filters. Collective on the world. Throws failure.
class Session {
public:
  Session(int &argc, char **&argv, const char *help = nullptr);
  ~Session();
  Session(const Session &) = delete;
  Session &operator=(const Session &) = delete;

private:
  std::optional<ErrorRecorder> recorder_;
};

} // namespace rbvi
