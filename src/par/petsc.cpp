#include "rbvi/par/petsc.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/io/h5.hpp"
#include "rbvi/par/session.hpp"

#include <algorithm>
#include <array>
#include <csignal>
#include <string>
#include <string_view>

namespace rbvi {

namespace {

// The handler runs inside C code and must not throw: fixed storage.
std::array<char, 1024> recorded{};
int recorders = 0;

PetscErrorCode record(MPI_Comm, int, const char *, const char *, PetscErrorCode code,
                      PetscErrorType type, const char *message, void *) {
  if (type == PETSC_ERROR_INITIAL && message != nullptr) {
    const std::string_view text = message;
    const std::size_t length = std::min(text.size(), recorded.size() - 1);
    std::copy_n(text.begin(), length, recorded.begin());
    recorded[length] = '\0';
  }
  return code;
}

std::string one_line(std::string_view text) {
  std::string line;
  for (const char c : text) {
    const bool blank = c == '\n' || c == '\r' || c == '\t' || c == ' ';
    if (!blank) line += c;
    if (blank && !line.empty() && line.back() != ' ') line += ' ';
  }
  if (!line.empty() && line.back() == ' ') line.pop_back();
  return line;
}

} // namespace

void throw_petsc_error(PetscErrorCode code, const char *call) {
  const char *general = nullptr;
  char *specific = nullptr;
  (void)PetscErrorMessage(code, &general, &specific);
  std::string message = one_line(recorded.data());
  recorded[0] = '\0';
  // PETSc keeps the message of its last error for ever: an old one if this code came without.
  if (recorders == 0 && specific != nullptr) message = one_line(specific);
  if (message.empty() && general != nullptr) message = one_line(general);
  if (message.empty()) message = "no message";
  if (code == PETSC_ERR_MAT_CH_ZRPVT || code == PETSC_ERR_MAT_LU_ZRPVT)
    throw failure(
        "a matrix is singular: is there a body that no fixed boundary or spring holds, or a "
        "material that is not stiff? (" +
        message + ")");
  // Where there is no memory, PETSc 3.18 may hand out the number of a line in place of a code.
  if (code == PETSC_ERR_MEM || code > PETSC_ERR_MAX_VALUE) message = "out of memory";
  const std::string_view name = call;
  throw failure(std::string(name.substr(0, name.find('('))) + ": " + message + " (PETSc error " +
                std::to_string(static_cast<int>(code)) + ")");
}

ErrorRecorder::ErrorRecorder() {
  recorded[0] = '\0';
  RBVI_CALL(PetscMallocGetDebug(&checked_memory_, nullptr, nullptr));
  RBVI_CALL(PetscPushErrorHandler(record, nullptr));
  ++recorders;
}

ErrorRecorder::~ErrorRecorder() {
  // Where -malloc_debug has put another allocator in place, as PETSc started, that one cannot free
  // what this one made: it stays.
  PetscBool checked = PETSC_FALSE;
  (void)PetscMallocGetDebug(&checked, nullptr, nullptr);
  if (checked == checked_memory_) (void)PetscPopErrorHandler();
  --recorders;
}

namespace {

/// PETSc's handler of signals would take a reader that has seen enough (rbvi list | head -1) for a
/// crash.
void end_quietly_without_reader() {
  (void)std::signal(SIGPIPE, SIG_DFL);
}

} // namespace

Session::Session(int &argc, char **&argv, const char *help) {
  recorder_.emplace();
  start_hdf5();
  RBVI_CALL(SlepcInitialize(&argc, &argv, nullptr, help));
  end_quietly_without_reader();
}

Session::~Session() {
  recorder_.reset();
  (void)SlepcFinalize();
}

} // namespace rbvi
