#include "rbvi/core/text.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <numeric>

namespace rbvi {

namespace {

std::size_t edits(const std::string &from, const std::string &to) {
  std::vector<std::size_t> row(to.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < from.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < to.size(); ++j) {
      const std::size_t replaced = diagonal + (from[i] == to[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

} // namespace

std::string formatted(const char *format, double value) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string short_number(double value) {
  return formatted("%.4g", value);
}

std::string counted(long number, const std::string &noun) {
  return std::to_string(number) + " " + noun + (number == 1 ? "" : "s");
}

std::string bytes_text(double bytes) {
  return bytes < 1e9 ? formatted("%.0f MB", bytes / 1e6) : formatted("%.3g GB", bytes / 1e9);
}

std::string joined(const std::vector<std::string> &parts, const std::string &separator) {
  std::string text;
  for (std::size_t i = 0; i < parts.size(); ++i)
    text += (i > 0 ? separator : "") + parts[i];
  return text;
}

std::string table_line(const std::vector<std::string> &parts, const std::string &begin,
                       const std::string &between, const std::string &end) {
  return begin + joined(parts, between) + end + "\n";
}

std::string shortest_number(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string trimmed(const std::string &text) {
  const std::string blanks = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

std::string nearest_name(const std::string &given, const std::vector<std::string> &names) {
  std::string completion;
  for (const std::string &name : names)
    if (given.size() > 1 && name.starts_with(given) &&
        (completion.empty() || name.size() < completion.size()))
      completion = name;
  if (!completion.empty()) return completion;
  const auto distance = [&](const std::string &name) {
    const auto parted = std::mismatch(given.begin(), given.end(), name.begin(), name.end()).first;
    return static_cast<long>(edits(given, name)) - (parted - given.begin());
  };
  const auto nearest =
      std::min_element(names.begin(), names.end(), [&](const std::string &a, const std::string &b) {
        return distance(a) < distance(b);
      });
  return nearest == names.end() ? "" : *nearest;
}

} // namespace rbvi
