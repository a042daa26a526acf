// Errors that gain context on the way up and end as one line with an exit status.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace rbvi {

/// Exit statuses of both tools: 0 done, 1 the computation failed, 2 the input is wrong.
enum class Status { done = 0, failed = 1, bad_input = 2 };

/// What went wrong, in one line that says what to do.
class Error : public std::runtime_error {
public:
  Error(Status status, const std::string &message) : std::runtime_error(message), status_(status) {}
  Status status() const noexcept { return status_; }

private:
  Status status_;
};

/// The computation failed although its input was valid (exit status 1).
inline Error failure(const std::string &message) {
  return {Status::failed, message};
}

/// The input is wrong; nothing has been written (exit status 2).
inline Error bad_input(const std::string &message) {
  return {Status::bad_input, message};
}

/// Runs `work`; an Error or std::exception that leaves it gains ", while <what>".
template <class Work> decltype(auto) while_doing(const std::string &what, Work &&work) {
  try {
    return std::forward<Work>(work)();
  } catch (const Error &error) {
    throw Error(error.status(), std::string(error.what()) + ", while " + what);
  } catch (const std::exception &error) {
    throw failure(std::string(error.what()) + ", while " + what);
  }
}

} // namespace rbvi
