#include "rbvi/scene/document.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/scene/case.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <optional>
#include <set>
#include <sstream>

namespace rbvi {

namespace {

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
      throw malformed(file, line, "it begins with a tab: indent with blanks");
    if (text[i] == '\n') ++line;
    indenting = text[i] == '\n' || (indenting && text[i] == ' ');
    i += size;
  }
}

/// Throws bad_input where a second document begins, by its first line.
void check_one_document(const std::string &text, const std::string &file) {
  std::istringstream in(text);
  int number = 0;
  bool content = false, ended = false;
  for (std::string line; std::getline(in, line);) {
    ++number;
    const std::size_t first = line.find_first_not_of(" \t\r");
    const bool idle = first == std::string::npos || line[first] == '#' || line[first] == '%';
    const bool mark = line.starts_with("---") || line.starts_with("...");
    if (mark) ended = content;
    if (idle || mark) continue;
    if (ended) throw malformed(file, number, "a second document begins: use one table");
    content = true;
  }
}

/// The one document of a file; undefined: there is none. (YAML::LoadAll does not end for some
/// texts that are damaged.)
YAML::Node document(const std::string &text, const std::string &file) {
  check_one_document(text, file);
  try {
    return YAML::Load(text);
  } catch (const YAML::Exception &error) {
    throw malformed(file, line_of(error.mark), error.msg + " ('name: value' is expected)");
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

std::size_t indent_of(const std::string &line) {
  return std::min(line.find_first_not_of(" \t\r"), line.size());
}

/// Whether a text begins behind this line, folded (>) or as it is (|).
bool opens_text(const std::string &line) {
  const std::string code = trimmed(line.substr(0, line.find(" #")));
  const std::size_t mark = code.find_last_not_of("+-123456789");
  return mark != std::string::npos && (code[mark] == '>' || code[mark] == '|') &&
         trimmed(code.substr(0, mark)).ends_with(':');
}

/// YAML folds further lines into a value, which nobody means without the mark of a text.
void check_lines(const std::string &text, const YAML::Node &root, const std::string &file) {
  std::set<int> begun;
  collect_lines(root, begun);
  std::istringstream in(text);
  int number = 0;
  std::optional<std::size_t> text_of; // how far the line is indented that a text belongs to
  for (std::string line; std::getline(in, line);) {
    ++number;
    const std::size_t first = indent_of(line);
    if (first == line.size() || (text_of && first > *text_of)) continue;
    text_of.reset();
    if (line[first] == '#' || line[first] == '%') continue;
    if (opens_text(line)) text_of = first;
    if (open_quote(line)) throw malformed(file, number, "a quote is not closed");
    const bool idle = line.starts_with("---") || line.starts_with("...") ||
                      line.find_first_not_of("[]{}, \t\r") == std::string::npos;
    if (!idle && !begun.contains(number))
      throw malformed(file, number,
                      "it belongs to no name: write 'name: value', or 'name: >' before a text of "
                      "several lines");
  }
}

CaseNode node_of(const YAML::Node &yaml, const std::string &file);

void add_entries(const YAML::Node &yaml, const std::string &file, CaseNode &table) {
  for (const auto &pair : yaml) {
    const int line = line_of(pair.first.Mark());
    if (!pair.first.IsScalar() || pair.first.Scalar().empty())
      throw malformed(file, line, "'name: value' is expected, with a name alone");
    const std::string &name = pair.first.Scalar();
    if (const CaseNode *first = table.find(name); first != nullptr)
      throw malformed(file, line,
                      name + " is given again, after line " + std::to_string(first->line) +
                          ": keep one of the two");
    CaseNode entry = node_of(pair.second, file);
    entry.line = line;
    entry.column = pair.first.Mark().column + 1;
    table.entries.push_back({name, std::move(entry)});
  }
}

CaseNode node_of(const YAML::Node &yaml, const std::string &file) {
  CaseNode node;
  node.line = line_of(yaml.Mark());
  node.column = std::max(0, yaml.Mark().column) + 1;
  if (yaml.IsMap()) {
    node.kind = CaseNode::Kind::table;
    add_entries(yaml, file, node);
  } else if (yaml.IsSequence()) {
    node.kind = CaseNode::Kind::list;
    for (const YAML::Node &item : yaml)
      node.items.push_back(node_of(item, file));
  } else if (yaml.IsScalar()) {
    node.value = yaml.Scalar();
    if (node.value.ends_with('\n')) node.value.pop_back(); // of a folded text
    if (node.value.find_first_of("\r\n") != std::string::npos)
      throw malformed(file, node.line,
                      "a value goes over several lines: fold it ('name: >'), without empty ones");
  }
  return node;
}

} // namespace

CaseNode parse_document(const std::string &text, const std::string &file) {
  const bool marked = text.starts_with(byte_order_mark);
  const std::string plain = marked ? text.substr(3) : text;
  check_text(plain, file);
  const YAML::Node root = document(plain, file);
  CaseNode table;
  table.kind = CaseNode::Kind::table;
  if (!root.IsDefined() || root.IsNull()) return table;
  if (!root.IsMap()) throw malformed(file, line_of(root.Mark()), "'name: value' is expected");
  check_lines(plain, root, file);
  return node_of(root, file);
}

bool is_scene_file(const std::string &text, const std::string &file) {
  const CaseNode root = parse_document(text, file);
  return std::ranges::any_of(std::vector{"rbvi", "physics", "contact", "parameters"},
                             [&](const char *name) {
                               const CaseNode *found = root.find(name);
                               return found != nullptr && (found->is_table() || *name != 'p');
                             });
}

SceneEntry read_case(const std::string &text, const std::string &file, const CaseChanges &changes) {
  return read_case(parse_document(text, file), file, changes);
}

} // namespace rbvi
