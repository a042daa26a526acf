#include "rbvi/tool/case_file.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/par/collective.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

namespace rbvi {

namespace {

constexpr std::size_t largest_file = 1 << 20;
constexpr const char *byte_order_mark = "\xef\xbb\xbf";

Error malformed(const std::string &file, int line, const std::string &what) {
  return bad_input("the case file " + file + " is malformed at line " + std::to_string(line) +
                   ": " + what);
}

int line_of(const YAML::Mark &mark) {
  return mark.is_null() ? 1 : mark.line + 1;
}

/// Bytes of the UTF-8 character that begins at i; 0: none does.
std::size_t character_size(const std::string &text, std::size_t i) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned first = byte(i);
  const std::size_t size = first < 0x80                    ? 1
                           : first >= 0xc2 && first < 0xe0 ? 2
                           : first >= 0xe0 && first < 0xf0 ? 3
                           : first >= 0xf0 && first < 0xf5 ? 4
                                                           : 0;
  if (size == 0 || i + size > text.size()) return 0;
  for (std::size_t k = 1; k < size; ++k)
    if ((byte(i + k) & 0xc0U) != 0x80U) return 0;
  const bool control = size == 1 && first < 0x20 && first != '\t' && first != '\n' && first != '\r';
  return control ? 0 : size;
}

/// What YAML libraries differ in, or let through.
void check_text(const std::string &text, const std::string &file) {
  int line = 1;
  bool indenting = true;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t size = character_size(text, i);
    if (size == 0) throw malformed(file, line, "a byte is no UTF-8 text");
    if (indenting && text[i] == '\t')
      throw malformed(file, line, "it begins with a tab: begin lines with the name of an option");
    if (text[i] == '\n') ++line;
    indenting = text[i] == '\n' || (indenting && text[i] == ' ');
    i += size;
  }
}

std::string name_of(const YAML::Node &key, const std::string &file) {
  const int line = line_of(key.Mark());
  if (!key.IsScalar())
    throw malformed(file, line, "one 'option: value' per line is expected, with a name alone");
  const std::string name = key.Scalar();
  const std::size_t dashes = std::min(name.find_first_not_of('-'), name.size());
  if (dashes > 0) throw malformed(file, line, "write " + name.substr(dashes) + " without the dash");
  const bool letters = std::all_of(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
  if (name.empty() || !letters || std::isalpha(static_cast<unsigned char>(name[0])) == 0)
    throw malformed(file, line, "'" + name + "' is no name of an option");
  return name;
}

std::string scalar_of(const YAML::Node &node) {
  return node.IsScalar() ? node.Scalar() : "";
}

std::string value_of(const std::string &name, const YAML::Node &node, const std::string &file) {
  const int line = line_of(node.Mark());
  if (node.IsMap()) {
    std::string option = name;
    if (node.size() > 0) option.append("_").append(scalar_of(node.begin()->first));
    throw malformed(file, line,
                    "options are not nested: write '" + option + ": value' on a line of its own");
  }
  std::string value = scalar_of(node);
  if (node.IsSequence()) {
    for (const YAML::Node &entry : node) {
      if (!entry.IsScalar())
        throw malformed(file, line, "the list of " + name + " holds more than plain values");
      value += (value.empty() ? "" : ",") + entry.Scalar();
    }
    if (value.empty()) throw malformed(file, line, "the list of " + name + " is empty");
  }
  if (value.find_first_of("\r\n") != std::string::npos)
    throw malformed(file, line, "the value of " + name + " goes over several lines");
  return value;
}

/// The one document of a file; undefined: there is none.
YAML::Node document(const std::string &text, const std::string &file) {
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.size() > 1)
      throw malformed(file, line_of(documents[1].Mark()),
                      "a second document begins, or the indentation "
                      "changes: use one map of options");
    return documents.empty() ? YAML::Node() : documents[0];
  } catch (const YAML::Exception &error) {
    throw malformed(file, line_of(error.mark),
                    error.msg + " (one 'option: value' per line is expected)");
  }
}

/// The lines on which a key, a value or an entry of a list begins.
void collect_lines(const YAML::Node &node, std::set<int> &lines) {
  lines.insert(line_of(node.Mark()));
  if (node.IsSequence())
    for (const YAML::Node &entry : node)
      collect_lines(entry, lines);
  if (node.IsMap())
    for (const auto &pair : node) {
      collect_lines(pair.first, lines);
      collect_lines(pair.second, lines);
    }
}

/// Whether a quote is opened behind the colon and not closed again.
bool open_quote(const std::string &line) {
  const std::size_t colon = line.find(':');
  if (colon == std::string::npos) return false;
  const std::size_t begin = line.find_first_not_of(" \t", colon + 1);
  if (begin == std::string::npos || (line[begin] != '"' && line[begin] != '\'')) return false;
  return line.find(line[begin], begin + 1) == std::string::npos;
}

/// YAML folds further lines into a value, which options never mean.
void check_lines(const std::string &text, const YAML::Node &root, const std::string &file) {
  std::set<int> begun;
  collect_lines(root, begun);
  std::istringstream in(text);
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#' || line[first] == '%') continue;
    if (open_quote(line)) throw malformed(file, number, "a quote is not closed");
    const bool idle = line.starts_with("---") || line.starts_with("...") ||
                      line.find_first_not_of("[]{}, \t\r") == std::string::npos;
    if (!idle && !begun.contains(number))
      throw malformed(file, number, "it belongs to no option: write 'option: value'");
  }
}

std::string broadcast(MPI_Comm comm, std::string text) {
  auto size = static_cast<unsigned long>(text.size());
  MPI_Bcast(&size, 1, MPI_UNSIGNED_LONG, 0, comm);
  text.resize(size);
  MPI_Bcast(text.data(), static_cast<int>(size), MPI_CHAR, 0, comm);
  return text;
}

} // namespace

std::vector<CaseEntry> parse_case_file(const std::string &text, const std::string &file) {
  const bool marked = text.starts_with(byte_order_mark);
  const std::string plain = marked ? text.substr(3) : text;
  check_text(plain, file);
  const YAML::Node root = document(plain, file);
  if (!root.IsDefined() || root.IsNull()) return {};
  if (!root.IsMap())
    throw malformed(file, line_of(root.Mark()), "one 'option: value' per line is expected");
  check_lines(plain, root, file);
  std::vector<CaseEntry> entries;
  std::map<std::string, int> lines;
  for (const auto &pair : root) {
    const std::string name = name_of(pair.first, file);
    const int line = line_of(pair.first.Mark());
    const auto [first, is_new] = lines.emplace(name, line);
    if (!is_new)
      throw malformed(file, line,
                      name + " is given again, after line " + std::to_string(first->second) +
                          ": keep one of the two");
    entries.push_back({name, value_of(name, pair.second, file), line});
  }
  return entries;
}

std::string case_line(const std::string &name, const std::string &value) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string("_./+,=:-").find(static_cast<char>(c)) != std::string::npos;
  };
  const bool bare = std::all_of(value.begin(), value.end(), plain) && !value.ends_with(':') &&
                    !value.starts_with('=') && !value.starts_with(',') && value != "-" &&
                    value != "null" && value != "Null" && value != "NULL" &&
                    !value.starts_with("---");
  if (bare) return name + ": " + value + "\n";
  std::string quoted;
  for (const char c : value)
    quoted += c == '\'' ? std::string("''") : std::string(1, c);
  return name + ": '" + quoted + "'\n";
}

std::string read_case_text(MPI_Comm comm, const std::filesystem::path &file) {
  const int rank = rank_of(comm);
  std::string text;
  collectively(comm, [&] {
    if (rank != 0) return;
    if (std::filesystem::is_directory(file))
      throw bad_input("the case file " + file.string() + " is a directory");
    std::ifstream in(file, std::ios::binary);
    if (!in) throw bad_input("the case file " + file.string() + " cannot be read");
    text.resize(largest_file + 1);
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(in.gcount());
    if (in.bad()) throw bad_input("the case file " + file.string() + " cannot be read");
    if (text.size() > largest_file)
      throw bad_input("the case file " + file.string() + " is larger than 1 MB: it is none");
  });
  return broadcast(comm, std::move(text));
}

} // namespace rbvi
