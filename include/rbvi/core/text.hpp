// Text for messages and tables: numbers, suggestions for mistyped names.
#pragma once

#include <string>
#include <vector>

namespace rbvi {

/// One number by a format of printf.
std::string formatted(const char *format, double value);

/// "%.4g".
std::string short_number(double value);

/// "1 mode", "2 modes".
std::string counted(long number, const std::string &noun);

/// "320 MB", "1.2 GB".
std::string bytes_text(double bytes);

/// "a, b, c".
std::string joined(const std::vector<std::string> &parts, const std::string &separator = ", ");

/// One line of a table: `begin`, the parts with `between` them, `end` and a line feed.
std::string table_line(const std::vector<std::string> &parts, const std::string &begin,
                       const std::string &between, const std::string &end);

/// The shortest text that reads back as the same number.
std::string shortest_number(double value);

/// Without blanks at both ends.
std::string trimmed(const std::string &text);

/// The shortest name that begins with what was given; else the one with the fewest single-letter
/// edits (Levenshtein), less one for each letter of a common beginning; "" if there is none.
std::string nearest_name(const std::string &given, const std::vector<std::string> &names);

} // namespace rbvi
