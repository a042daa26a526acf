// The dialect of our CSV tables.
#pragma once

#include <string>
#include <vector>

namespace rbvi {

/// The fields of a row; those in double quotes may hold commas, and quotes that are doubled. Throws
/// bad_input for a quote that is not closed.
std::vector<std::string> csv_fields(const std::string &line);

/// In double quotes, which are doubled inside, without line breaks: one field of a row.
std::string csv_quoted(const std::string &text);

} // namespace rbvi
