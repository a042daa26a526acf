// What the operating system says of files that it refuses.
#pragma once

#include "rbvi/core/error.hpp"

#include <string>

namespace rbvi {

/// ": No such file or directory", the reason of the last call that failed (errno); "" without one.
std::string system_reason();

/// The failure to write a file, or "to standard output", with that reason.
Error cannot_write(const std::string &what);

/// A message without the names that libraries have for want of memory, and with what to do then.
std::string in_plain_words(std::string message);

} // namespace rbvi
