#include "dimensions.hpp"
#include "rbvi/core/outputs.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/scene/case.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// Without `units:` units are labels of one system. Defects: two of one dimension that are of
/// different sizes, and degrees.
void check_labels(const CaseNode &parameters, Defects &defects) {
  std::map<Dimension, std::pair<double, std::string>> sizes{{{}, {1, "radians"}}};
  for (const auto &[name, node] : parameters.entries) {
    const CaseNode *unit = node.find("unit");
    if (unit == nullptr || unit_behind("1 " + unit->value).empty()) continue;
    const std::string &own = unit->value;
    const double size = from_unit(1, own, {});
    const auto [known, is_new] = sizes.try_emplace(dimension_of(own), size, own);
    if (known->second.first != size)
      defects.add(*unit, "without 'units:' a unit is a label and numbers are of one system, and " +
                             own + " and " + known->second.second +
                             " are of none: write units: {length: mm, force: N}");
  }
}

/// The keys of one table.
std::vector<const CaseKey *> keys_of(const std::string &table) {
  std::vector<const CaseKey *> keys;
  for (const CaseKey &key : case_keys())
    if (key.table == table) keys.push_back(&key);
  return keys;
}

std::string below(const std::string &table, const std::string &name) {
  return table.empty() ? name : table + "." + name;
}

/// Names of an expression that nothing declares.
void check_names(const Reader &reader, const CaseNode &node, const std::vector<std::string> &known,
                 Defects &defects) {
  defects.collect(node, [&] {
    const Expression value = expression_in(reader, node);
    for (const std::string &name : value.free_names())
      if (std::ranges::find(known, name) == known.end())
        throw bad_input("unknown name '" + name + "' in '" + node.value + "': the nearest is '" +
                        nearest_name(name, known) + "'");
  });
}

/// "contact.*.friction" -> "contact: friction"
std::string in_words(const std::string &table) {
  std::vector<std::string> names;
  for (const std::string &name : split(table, '.'))
    if (name != "*") names.push_back(name);
  return joined(names, ": ");
}

bool may_be_list(const CaseKey &key) {
  for (const char *part :
       {"[", "expressions", "names", "regions", "boundar", "list", "anything", "table"})
    if (key.value.find(part) != std::string::npos) return true;
  return false;
}

class Walk {
public:
  Walk(const Reader &reader, Defects &defects)
      : reader_(reader), defects_(defects), dimensions_(reader) {
    known_ = {"x", "y", "z", "nx", "ny", "nz"};
    for (const char *section_name : {"parameters", "let"})
      for (const auto &[name, node] : section(reader, section_name).entries)
        known_.push_back(name);
    for (const auto &[name, node] : section(reader, "parameters").entries)
      if (const CaseNode *values = node.find("values"))
        for (const std::string &value : names_in(*values))
          known_.push_back(value);
    in_outputs_ = known_;
    in_outputs_.insert(in_outputs_.end(), output_fields().begin(), output_fields().end());
  }

  /// An entry of the table whose keys are those of `table`.
  void visit(const CaseNode &node, const std::string &table) {
    const std::vector<const CaseKey *> keys = keys_of(table);
    std::vector<std::string> names;
    for (const CaseKey *key : keys)
      names.push_back(key->name);
    for (const auto &[name, value] : node.entries) {
      const auto own = std::ranges::find(names, name);
      const auto any = own != names.end() ? own : std::ranges::find(names, std::string("*"));
      if (any == names.end())
        defects_.add(value, "unknown key '" + name + "'" +
                                (table.empty() ? std::string() : " of " + in_words(table)) +
                                ": the nearest is '" + nearest_name(name, names) + "'" +
                                (name.find_first_of("(): ?") == std::string::npos
                                     ? ""
                                     : " (quote a text or an expression that has a comma)"));
      else
        check(*keys[static_cast<std::size_t>(any - names.begin())], name, value, table,
              unit_of(node));
    }
    std::string missing; // of one place one defect is told
    for (const CaseKey *key : keys)
      if (key->needed && node.find(key->name) == nullptr)
        missing.append(missing.empty() ? "'" : "; '")
            .append(key->name)
            .append("' is missing (")
            .append(key->value)
            .append(key->says.empty() ? ")" : ": " + key->says + ")");
    if (!missing.empty()) defects_.add(node, missing);
  }

private:
  /// `own`: the unit of a parameter.
  void check(const CaseKey &key, const std::string &name, const CaseNode &value,
             const std::string &table, const std::string &own) {
    const bool may_be_table = key.value.find("table") != std::string::npos;
    if (value.is_table()) {
      if (!may_be_table && key.value != "anything")
        defects_.add(value, name + " is no table: " + key.value + " belongs here");
      else
        visit_table(name, value, table);
      return;
    }
    if (value.kind == CaseNode::Kind::list && !may_be_list(key)) {
      defects_.add(value, name + " is a list: " + key.value + " belongs here");
      return;
    }
    if (!key.dimension.empty() || key.value.find("expression") != std::string::npos ||
        key.value.find("number") != std::string::npos)
      defects_.collect(value, [&] { check_dimension(key, value, own); });
    if (key.value == "table" && !(value.is_value() && value.value.empty()))
      defects_.add(value, name + " is a table: write 'NAME: value' below it, or {NAME: value}");
    else if (key.value == "expression" ||
             (key.value == "expression | motion" && value.value != "motion"))
      check_names(reader_, value, table == "outputs.*" ? in_outputs_ : known_, defects_);
    else if (key.value.starts_with("expressions") || key.value.starts_with("[expression"))
      for (const CaseNode &item : value.items)
        check_names(reader_, item, known_, defects_);
  }

  void check_dimension(const CaseKey &key, const CaseNode &value, const std::string &own) const {
    const std::string physics = section(reader_, "physics").value;
    const bool force = key.dimension.starts_with("N");
    const bool thin = (key.table == "imposed.*" || key.table == "springs.*") && force &&
                      physics.starts_with("plane");
    // The tension of a membrane is 1, a force per length.
    const bool flat = key.table == "loads.*" && physics == "membrane";
    try {
      dimensions_.check(value, key.table == "parameters.*" ? own
                               : thin                      ? key.dimension + "/m"
                               : flat                      ? key.dimension + "*m"
                                                           : key.dimension);
    } catch (const Error &error) {
      const std::string unit = thin ? unit_in(*reader_.units, dimension_of("N/m")) : "";
      throw bad_input((thin ? "in plane problems forces are per thickness (" + unit + "): " : "") +
                      error.what());
    }
  }

  void visit_table(const std::string &name, const CaseNode &value, const std::string &table) {
    const std::string own = below(table, name);
    if (own == "choices" || own == "variants" || own == "options") return; // read on their own
    if (!keys_of(own).empty()) {
      visit(value, own);
    } else if (!keys_of(own + ".*").empty()) {
      for (const auto &[entry_name, entry_node] : value.entries)
        if (entry_node.is_table())
          visit(entry_node, own + ".*");
        else
          defects_.add(entry_node, entry_name + " is a table: write {NAME: VALUE, ...}");
    }
  }

  const Reader &reader_;
  Defects &defects_;
  Dimensions dimensions_;
  std::vector<std::string> known_, in_outputs_;
};

/// Parameters and lets are called as nothing else in expressions, parameters as no column of
/// tables.
void check_own_names(const Reader &reader, Defects &defects) {
  for (const char *section_name : {"parameters", "let"})
    for (const auto &[name, node] : section(reader, section_name).entries)
      defects.collect(node, [&, &own = name, is_let = std::string(section_name) == "let"] {
        if (is_coordinate(own)) throw bad_input("'" + own + "' is the name of a coordinate");
        if (!is_name(own))
          throw bad_input("'" + own +
                          "' is no name that an expression can have: letters, digits "
                          "and _, and neither pi, and, or, not nor a function");
        if (!is_let && is_table_column(own))
          throw bad_input("tables have a column '" + own +
                          "' already: give the parameter another "
                          "name");
      });
}

} // namespace

void check_keys(const Reader &reader, Defects &defects) {
  check_own_names(reader, defects);
  if (!reader.units) check_labels(section(reader, "parameters"), defects);
  Walk(reader, defects).visit(reader.root, "");
}

} // namespace rbvi
