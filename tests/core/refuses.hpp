// A refusal that a user can read.
#pragma once

#include "rbvi/core/error.hpp"

#include <gtest/gtest.h>

namespace rbvi {

/// Whether `work` throws bad_input with one line that contains `part`.
template <class Work> testing::AssertionResult refuses(const std::string &part, Work &&work) {
  try {
    work();
  } catch (const Error &error) {
    const std::string message = error.what();
    const bool ok = error.status() == Status::bad_input &&
                    message.find(part) != std::string::npos &&
                    message.find('\n') == std::string::npos;
    return (ok ? testing::AssertionSuccess() : testing::AssertionFailure()) << message;
  }
  return testing::AssertionFailure() << "accepted";
}

} // namespace rbvi
