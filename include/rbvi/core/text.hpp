// Text for messages: short numbers, suggestions for mistyped names.
#pragma once

#include <string>
#include <vector>

namespace rbvi {

/// "%.4g".
std::string short_number(double value);

/// The shortest name that begins with what was given; else the one with the fewest single-letter
/// edits (Levenshtein); "" if there is none.
std::string nearest_name(const std::string &given, const std::vector<std::string> &names);

} // namespace rbvi
