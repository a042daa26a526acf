#include "rbvi/core/text.hpp"
#include "rbvi/scene/case.hpp"

#include <algorithm>
#include <cctype>

namespace rbvi {

namespace {

/// Of an object: name -> JSON.
using Members = std::vector<std::pair<std::string, std::string>>;

bool has(const std::string &text, const char *part) {
  return text.find(part) != std::string::npos;
}

std::string in_quotes(const std::string &text) {
  std::string json = "\"";
  for (const char letter : text)
    json.append(letter == '"' || letter == '\\' ? "\\" : "").append(1, letter);
  return json + "\"";
}

std::string json_list(const std::vector<std::string> &items) {
  return "[" + joined(items) + "]";
}

/// On one line if it is short, else a member on each.
std::string json_object(const Members &members) {
  std::vector<std::string> parts;
  for (const auto &[name, value] : members)
    parts.push_back(in_quotes(name) + ": " + value);
  const std::string line = "{" + joined(parts) + "}";
  if (line.size() < 90 && !has(line, "\n")) return line;
  std::string text = "\n" + joined(parts, ",\n");
  for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 1))
    text.insert(at + 1, "  ");
  return "{" + text + "\n}";
}

/// YAML takes yes and no for words or, in its version 1.1, for what is true and false.
Members one_of(const std::string &alternatives) {
  std::vector<std::string> all;
  for (const std::string &part : split(alternatives, '|')) {
    const std::string word = trimmed(part);
    const bool number = std::isdigit(static_cast<unsigned char>(word[0])) != 0;
    all.push_back(number ? word : in_quotes(word));
    if (word == "yes") all.emplace_back("true");
    if (word == "no") all.emplace_back("false");
  }
  return {{"enum", json_list(all)}};
}

/// What the words of the table of keys allow.
Members members_of(const std::string &value) {
  if (value == "anything") return {};
  const bool open = has(value, "expression") || has(value, "parameter");
  if ((has(value, " | ") && !has(value, "[") && !open) || value == "1") return one_of(value);
  std::vector<std::string> types;
  Members members;
  if (!value.starts_with("[") && value != "table") {
    types = {"\"string\"", "\"number\""};
    if (!value.starts_with("expression") && value != "number") types.emplace_back("\"boolean\"");
  }
  if (has(value, "table")) types.insert(types.end(), {"\"object\"", "\"null\""});
  const std::vector<const char *> several{"[",       "expressions", "names",
                                          "regions", "boundaries",  "list"};
  if (std::ranges::any_of(several, [&](const char *word) { return has(value, word); }))
    types.emplace_back("\"array\"");
  members.emplace_back("type", types.size() == 1 ? types.front() : json_list(types));
  if (!has(value, "[")) return members;
  const std::size_t begin = value.find('[') + 1;
  const std::vector<std::string> items = split(value.substr(begin, value.find(']') - begin), ',');
  members.emplace_back("items", json_object(members_of(trimmed(items.front()))));
  members.emplace_back("minItems", std::to_string(items.size()));
  members.emplace_back("maxItems", std::to_string(items.size()));
  return members;
}

/// The keys of a table; those of its entries where their names are the author's.
Members members_of_table(const std::string &table) {
  Members properties, members;
  std::vector<std::string> needed;
  std::string others = "false", entries;
  for (const CaseKey &key : case_keys()) {
    if (key.table == table + ".*") entries = key.table;
    if (key.table != table) continue;
    Members own = members_of(key.value);
    if (!key.says.empty()) own.emplace_back("description", in_quotes(key.says));
    const std::string below = (table.empty() ? "" : table + ".") + key.name;
    for (auto &member : members_of_table(below))
      own.push_back(std::move(member));
    if (key.name == "*")
      others = json_object(own);
    else
      properties.emplace_back(key.name, json_object(own));
    if (key.needed) needed.push_back(in_quotes(key.name));
  }
  if (!entries.empty()) {
    Members entry = members_of_table(entries);
    entry.insert(entry.begin(), {"type", "\"object\""});
    return {{"additionalProperties", json_object(entry)}};
  }
  if (properties.empty() && others == "false") return {};
  if (!properties.empty()) members.emplace_back("properties", json_object(properties));
  if (!needed.empty()) members.emplace_back("required", json_list(needed));
  members.emplace_back("additionalProperties", others);
  return members;
}

} // namespace

std::string case_schema() {
  Members members{{"$schema", in_quotes("http://json-schema.org/draft-07/schema#")},
                  {"title", in_quotes("rbvi case file")},
                  {"type", in_quotes("object")}};
  for (auto &member : members_of_table(""))
    members.push_back(std::move(member));
  return json_object(members) + "\n";
}

} // namespace rbvi
