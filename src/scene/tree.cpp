#include "rbvi/scene/tree.hpp"

#include <algorithm>
#include <cstdlib>

namespace rbvi {

namespace {

constexpr const char *marks = "\\.:[{"; ///< of a path

std::string escaped(const std::string &name) {
  std::string result;
  for (const char c : name) {
    if (std::string(marks).find(c) != std::string::npos) result += '\\';
    result += c;
  }
  return result;
}

void add_values(const CaseNode &node, const std::string &path,
                std::vector<std::pair<std::string, std::string>> &values) {
  if (node.is_value()) values.emplace_back(path, node.value);
  if (node.kind == CaseNode::Kind::list && node.items.empty()) values.emplace_back(path + "[]", "");
  if (node.is_table() && node.entries.empty()) values.emplace_back(path + "{}", "");
  for (std::size_t i = 0; i < node.items.size(); ++i)
    add_values(node.items[i], path + "[" + std::to_string(i) + "]", values);
  for (const auto &[name, entry] : node.entries)
    add_values(entry, (path.empty() ? "" : path + ".") + escaped(name), values);
}

/// A name of a path from i on, which goes behind it.
std::string next_name(const std::string &line, std::size_t &i) {
  std::string name;
  for (; i < line.size() && std::string(marks + 1).find(line[i]) == std::string::npos; ++i) {
    if (line[i] == '\\') ++i;
    if (i < line.size()) name += line[i];
  }
  return name;
}

/// The node that a path leads to: what a list or a table had last, or what comes next in it.
/// `i` goes behind the path.
CaseNode &at_path(CaseNode &root, const std::string &line, std::size_t &i) {
  CaseNode *at = &root;
  while (i < line.size() && line[i] != ':') {
    const std::string mark = line.substr(i, 2);
    if (mark == "[]" || mark == "{}") {
      at->kind = mark == "[]" ? CaseNode::Kind::list : CaseNode::Kind::table;
      i += 2;
    } else if (line[i] == '[') {
      at->kind = CaseNode::Kind::list;
      const bool last = std::strtoul(&line[i + 1], nullptr, 10) < at->items.size();
      at = last ? &at->items.back() : &at->items.emplace_back();
      i = std::min(line.find(']', i), line.size() - 1) + 1;
    } else {
      if (line[i] == '.') ++i;
      const std::string name = next_name(line, i);
      if (name.empty()) break; // no path
      at->kind = CaseNode::Kind::table;
      if (at->entries.empty() || at->entries.back().name != name) at->entries.push_back({name, {}});
      at = &at->entries.back().node;
    }
  }
  return *at;
}

} // namespace

const CaseNode *CaseNode::find(const std::string &name) const {
  const auto found = std::ranges::find(entries, name, &CaseNode::Entry::name);
  return found == entries.end() ? nullptr : &found->node;
}

std::vector<std::pair<std::string, std::string>> values_of(const CaseNode &root) {
  std::vector<std::pair<std::string, std::string>> values;
  add_values(root, "", values);
  return values;
}

std::string text_of(const CaseNode &root) {
  std::string text;
  for (const auto &[path, value] : values_of(root))
    text.append(path).append(": ").append(value).append("\n");
  return text;
}

CaseNode tree_in(const std::string &text) {
  CaseNode root;
  root.kind = CaseNode::Kind::table;
  for (std::size_t begin = 0, end = 0; begin < text.size(); begin = end + 1) {
    end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    std::size_t behind = 0;
    CaseNode &node = at_path(root, line, behind);
    if (line.compare(behind, 2, ": ") != 0)
      throw bad_input("a scene is stored as lines 'path: value', and '" + line + "' is none");
    node.value = line.substr(behind + 2);
  }
  return root;
}

bool replace(CaseNode &root, const std::string &path, const CaseNode &value) {
  const bool takes_away = value.is_value() && value.value.empty();
  CaseNode *at = &root;
  std::size_t begin = 0;
  for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.', begin)) {
    const std::string name = path.substr(begin, dot - begin);
    begin = dot + 1;
    const auto found = std::ranges::find(at->entries, name, &CaseNode::Entry::name);
    if (found != at->entries.end()) {
      at = &found->node;
    } else if (takes_away) {
      return true;
    } else {
      CaseNode table{CaseNode::Kind::table, "", {}, {}, value.line, value.column};
      at = &at->entries.emplace_back(CaseNode::Entry{name, std::move(table)}).node;
    }
    if (!at->is_table() && !(at->is_value() && at->value.empty())) return false;
    at->kind = CaseNode::Kind::table;
  }
  const std::string name = path.substr(begin);
  const auto found = std::ranges::find(at->entries, name, &CaseNode::Entry::name);
  if (found == at->entries.end()) {
    if (!takes_away) at->entries.push_back({name, value});
  } else if (takes_away) {
    at->entries.erase(found);
  } else {
    found->node = value;
  }
  return true;
}

void Defects::add(const CaseNode &at, const std::string &what) {
  const bool told = std::ranges::any_of(all_, [&](const Defect &other) {
    return other.line == at.line && other.column == at.column && at.line != 0;
  });
  if (!told) all_.push_back({at.line, at.column, what});
}

void Defects::throw_all() const {
  if (all_.empty()) return;
  std::vector<Defect> sorted = all_;
  std::ranges::stable_sort(sorted, [](const Defect &a, const Defect &b) {
    return std::pair(a.line, a.column) < std::pair(b.line, b.column);
  });
  std::string text;
  for (const Defect &defect : sorted)
    text += (text.empty() ? "" : "\n") + file_ + ":" +
            (defect.line == 0
                 ? "" // of what is not there
                 : std::to_string(defect.line) + ":" + std::to_string(defect.column) + ":") +
            " " + defect.what;
  throw bad_input(text);
}

} // namespace rbvi
