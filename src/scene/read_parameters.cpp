#include "reader.hpp"

#include "rbvi/core/text.hpp"
#include "rbvi/core/validity.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// A positive range beyond a decade is one of a logarithm.
constexpr double decade = 10;

Range rising(const Range &range) {
  if (!(range.lower < range.upper))
    throw bad_input("[" + short_number(range.lower) + ", " + short_number(range.upper) +
                    "]: the lower bound comes first");
  return range;
}

bool holds(const Range &range, double value) {
  return value >= range.lower && value <= range.upper;
}

/// Of a choice, with names of its values.
Parameter choice_in(const std::string &name, const CaseNode &node, const CaseNode &values) {
  Parameter parameter{name, ""};
  for (const char *of_numbers : {"range", "limits", "unit", "spacing"})
    if (node.find(of_numbers) != nullptr)
      throw bad_input(name + " has values: it has no '" + std::string(of_numbers) + "'");
  parameter.choices = names_in(values);
  const auto is_own = [](const std::string &text) { return is_name(text) && !is_coordinate(text); };
  if (parameter.choices.size() < 2 || !std::ranges::all_of(parameter.choices, is_own))
    throw bad_input("the values of " + name + " are names, two at least: [steel, brass]");
  parameter.value = parse_value(parameter, entry(node, "default").value, "the default of " + name);
  parameter.upper = static_cast<double>(parameter.choices.size() - 1);
  if (parameter.value != taken(parameter, parameter.value))
    throw bad_input("the default of " + name + " is one of " + joined(parameter.choices));
  return parameter;
}

Parameter parameter_in(Reader &reader, const std::string &name, const CaseNode &node) {
  if (const CaseNode *values = node.find("values")) return choice_in(name, node, *values);
  const std::string unit = unit_of(node);
  Parameter parameter{name, unit, 0, 0, number_in(reader, entry(node, "default"), unit)};
  parameter.lower = parameter.upper = parameter.value;
  if (const CaseNode *limits = node.find("limits"))
    parameter.valid = rising(range_in(reader, *limits, unit));
  const CaseNode *range = node.find("range");
  if (range != nullptr) {
    const Range own = rising(range_in(reader, *range, unit));
    parameter.lower = own.lower;
    parameter.upper = own.upper;
    if (!holds(own, parameter.value))
      throw bad_input("the default of " + name + ", " + short_number(parameter.value) +
                      ", lies outside of its range");
  }
  return parameter;
}

/// Another name for the value of a parameter in its unit, and the let that makes the parameter of
/// it.
std::string value_in_unit(Reader &reader, const std::string &name, const std::string &unit) {
  const double size = size_of(reader, unit);
  if (size == 1) return name;
  std::string value = name + "_in_its_unit";
  while (section(reader, "parameters").find(value) != nullptr ||
         section(reader, "let").find(value) != nullptr)
    value += '_';
  reader.lets.push_back({name, parse_expression(shortest_number(size) + " * " + value)});
  return value;
}

bool is_log_spaced(const CaseNode &node, const Parameter &parameter) {
  const bool wide = parameter.lower > 0 && parameter.upper > decade * parameter.lower;
  const std::string spacing =
      choice_or(node, "spacing", wide ? "log" : "linear", {"linear", "log"});
  if (spacing == "log" && !(parameter.lower > 0))
    throw bad_input("the range of " + parameter.name + " is not positive: leave out spacing: log");
  return spacing == "log";
}

void check_new(const Reader &reader, const std::string &name) {
  if (std::ranges::find(reader.parameters, name) != reader.parameters.end() ||
      std::ranges::find(reader.lets, name, &Let::name) != reader.lets.end())
    throw bad_input("there is a parameter '" + name + "' already");
}

void read_constants(Reader &reader, Defects &defects) {
  for (const auto &[name, node] : section(reader, "parameters").entries)
    if (is_constant(node))
      defects.collect(node, [&, &own = name, &value = node] {
        check_new(reader, own);
        const Parameter constant = parameter_in(reader, own, value);
        reader.constants.push_back(constant);
        const double seen = size_of(reader, constant.unit) * constant.value;
        reader.lets.push_back({own, Expression({{Operation::number, 0, seen}}, {})});
      });
}

/// Names of choices are their numbers in expressions.
void read_names_of_choices(Reader &reader, Defects &defects) {
  for (const auto &[name, node] : section(reader, "parameters").entries)
    if (const CaseNode *values = node.find("values"))
      defects.collect(*values, [&] {
        const std::vector<std::string> names = names_in(*values);
        for (std::size_t k = 0; k < names.size(); ++k) {
          const auto other = std::ranges::find(reader.lets, names[k], &Let::name);
          if (other != reader.lets.end() && other->value.constant() == static_cast<double>(k))
            continue; // of another parameter with these values
          check_new(reader, names[k]);
          reader.lets.push_back({names[k], parse_expression(std::to_string(k))});
        }
      });
}

void read_lets(Reader &reader, Defects &defects) {
  for (const auto &[name, node] : section(reader, "let").entries)
    defects.collect(node, [&, &own = name, &value = node] {
      check_new(reader, own);
      const Expression expression = expression_in(reader, value);
      for (const std::string &used : expression.free_names())
        if (!is_coordinate(used) && section(reader, "parameters").find(used) == nullptr &&
            std::ranges::find(reader.lets, used, &Let::name) == reader.lets.end())
          throw bad_input("unknown name '" + used + "' in '" + value.value +
                          "': it may have parameters, coordinates and what stands above it");
      reader.lets.push_back({own, expression});
    });
}

Parameter *named(Reader &reader, const std::string &name, Scene &scene) {
  for (std::vector<Parameter> *all : {&scene.parameters.all, &reader.constants}) {
    const auto found = std::ranges::find(*all, name, &Parameter::name);
    if (found != all->end()) return &*found;
  }
  return nullptr;
}

} // namespace

void limit(Reader &reader, const Expression &value, const Range &range, Scene &scene) {
  if (value.program().size() != 1 || value.free_names().size() != 1) return;
  Parameter *parameter = named(reader, value.free_names().front(), scene);
  if (parameter == nullptr) return;
  const double size = size_of(reader, parameter->unit);
  parameter->valid.lower = std::max(parameter->valid.lower, range.lower / size);
  parameter->valid.upper = std::min(parameter->valid.upper, range.upper / size);
}

void check_limits(const Reader &reader, const Scene &scene, Defects &defects) {
  std::vector<Parameter> all = scene.parameters.all;
  all.insert(all.end(), reader.constants.begin(), reader.constants.end());
  for (const Parameter &parameter : all) {
    const CaseNode &node = *section(reader, "parameters").find(parameter.name);
    if (!holds(parameter.valid, parameter.value))
      defects.add(node, "parameter " + parameter.name + " is " + short_number(parameter.value) +
                            ", outside of " + describe(parameter.valid) +
                            " (its limits, and those of what it is)");
  }
}

void read_parameters(Reader &reader, Scene &scene, Defects &defects) {
  const CaseNode &all = section(reader, "parameters");
  read_constants(reader, defects);
  read_names_of_choices(reader, defects);
  for (const auto &[name, node] : all.entries)
    if (!is_constant(node) && (reader.used.empty() || reader.used.contains(name)))
      defects.collect(node, [&, &own = name, &value = node] {
        reader.values.push_back(value_in_unit(reader, own, unit_of(value)));
        reader.parameters.push_back(own);
      });
  reader.used.clear();
  read_lets(reader, defects);
  for (const auto &[name, node] : all.entries) {
    if (std::ranges::find(reader.parameters, name) == reader.parameters.end()) continue;
    defects.collect(node, [&, &own = name, &value = node] {
      const Parameter parameter = parameter_in(reader, own, value);
      if (is_log_spaced(value, parameter))
        scene.coordinates[int(scene.parameters.all.size())] = {logarithm(), exponential()};
      scene.parameters.all.push_back(parameter);
    });
  }
}

} // namespace rbvi
