#include "rbvi/tool/case_file.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/scene/document.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>

namespace rbvi {

namespace {

constexpr std::size_t largest_file = 1 << 20;

Error malformed(const std::string &file, int line, const std::string &what) {
  return bad_input("the case file " + file + " is malformed at line " + std::to_string(line) +
                   ": " + what);
}

void check_name(const std::string &name, int line, const std::string &file) {
  const std::size_t dashes = std::min(name.find_first_not_of('-'), name.size());
  if (dashes > 0) throw malformed(file, line, "write " + name.substr(dashes) + " without the dash");
  const bool letters = std::all_of(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
  if (!letters || std::isalpha(static_cast<unsigned char>(name[0])) == 0)
    throw malformed(file, line, "'" + name + "' is no name of an option");
}

std::string value_of(const std::string &name, const CaseNode &node, const std::string &file) {
  if (node.is_table()) {
    std::string option = name;
    if (!node.entries.empty()) option.append("_").append(node.entries.front().name);
    throw malformed(file, node.line,
                    "options are not nested: write '" + option + ": value' on a line of its own");
  }
  if (node.is_value()) return node.value;
  std::vector<std::string> items;
  for (const CaseNode &item : node.items) {
    if (!item.is_value())
      throw malformed(file, node.line, "the list of " + name + " holds more than plain values");
    items.push_back(item.value);
  }
  if (items.empty()) throw malformed(file, node.line, "the list of " + name + " is empty");
  return joined(items, ",");
}

std::string broadcast(MPI_Comm comm, std::string text) {
  auto size = static_cast<unsigned long>(text.size());
  MPI_Bcast(&size, 1, MPI_UNSIGNED_LONG, 0, comm);
  text.resize(size);
  MPI_Bcast(text.data(), static_cast<int>(size), MPI_CHAR, 0, comm);
  return text;
}

} // namespace

std::vector<CaseSetting> parse_options(const std::string &text, const std::string &file) {
  std::vector<CaseSetting> entries;
  for (const auto &[name, node] : parse_document(text, file).entries) {
    check_name(name, node.line, file);
    entries.push_back({name, value_of(name, node, file), node.line});
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
  return name + ": " + (bare ? value : in_quotes(value)) + "\n";
}

std::string in_quotes(const std::string &text) {
  std::string quoted;
  for (const char c : text)
    quoted += c == '\'' ? std::string("''") : std::string(1, c);
  return "'" + quoted + "'";
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
