#include "reader.hpp"

#include "rbvi/core/text.hpp"
#include "rbvi/core/validity.hpp"

#include <algorithm>

namespace rbvi {

namespace {

/// A positive range beyond a decade is one of a logarithm.
constexpr double decade = 10;

Range range_in(const Reader &reader, const CaseNode &node) {
  const std::vector<double> bounds = numbers_in(reader, node, 2);
  if (!(bounds[0] < bounds[1]))
    throw bad_input("[" + short_number(bounds[0]) + ", " + short_number(bounds[1]) +
                    "]: the lower bound comes first");
  return {bounds[0], bounds[1]};
}

bool holds(const Range &range, double value) {
  return value >= range.lower && value <= range.upper;
}

/// That of the first of its numbers that has a unit; none of an expression.
Dimension dimension_of_numbers(const Reader &reader, const CaseNode &node) {
  for (const char *key : {"default", "range"})
    if (const CaseNode *numbers = node.find(key); numbers != nullptr)
      for (const CaseNode &one :
           numbers->items.empty() ? std::vector<CaseNode>{*numbers} : numbers->items)
        try {
          const Quantity quantity = parse_quantity(one.value, reader.units);
          if (quantity.has_unit) return quantity.dimension;
        } catch (const Error &) { // an expression, or what is refused where it is read
        }
  return {};
}

Parameter parameter_in(Reader &reader, const std::string &name, const CaseNode &node) {
  Parameter parameter{name, "", 0, 0, number_in(reader, entry(node, "default"))};
  parameter.lower = parameter.upper = parameter.value;
  if (const CaseNode *unit = node.find("unit"))
    parameter.unit = unit->value;
  else if (reader.units)
    parameter.unit = unit_in(*reader.units, dimension_of_numbers(reader, node));
  for (const char *name_of_numbers : {"range", "default", "limits"})
    if (const CaseNode *numbers = node.find(name_of_numbers); numbers != nullptr && reader.units)
      check_unit(reader, *numbers, parameter.unit);
  if (const CaseNode *limits = node.find("limits")) parameter.valid = range_in(reader, *limits);
  const CaseNode *range = node.find("range");
  if (range != nullptr) {
    const Range own = range_in(reader, *range);
    parameter.lower = own.lower;
    parameter.upper = own.upper;
    if (!holds(own, parameter.value))
      throw bad_input("the default of " + name + ", " + short_number(parameter.value) +
                      ", lies outside of its range");
  }
  return parameter;
}

bool is_log_spaced(const CaseNode &node, const Parameter &parameter) {
  const bool wide = parameter.lower > 0 && parameter.upper > decade * parameter.lower;
  const std::string spacing =
      choice_or(node, "spacing", wide ? "log" : "linear", {"linear", "log"});
  if (spacing == "log" && !(parameter.lower > 0))
    throw bad_input("the range of " + parameter.name + " is not positive: leave out spacing: log");
  return spacing == "log";
}

bool is_constant(const CaseNode &parameter) {
  return parameter.find("range") == nullptr;
}

void check_new(const Reader &reader, const std::string &name) {
  if (is_coordinate(name)) throw bad_input("'" + name + "' is the name of a coordinate");
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
        reader.lets.push_back({own, Expression({{Operation::number, 0, constant.value}}, {})});
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
  parameter->valid.lower = std::max(parameter->valid.lower, range.lower);
  parameter->valid.upper = std::min(parameter->valid.upper, range.upper);
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
  for (const auto &[name, node] : all.entries)
    if (!is_constant(node) && (reader.used.empty() || reader.used.contains(name)))
      reader.parameters.push_back(name);
  reader.used.clear();
  read_lets(reader, defects);
  for (const auto &[name, node] : all.entries) {
    if (std::ranges::find(reader.parameters, name) == reader.parameters.end()) continue;
    defects.collect(node, [&, &own = name, &value = node] {
      if (is_coordinate(own)) throw bad_input("'" + own + "' is the name of a coordinate");
      const Parameter parameter = parameter_in(reader, own, value);
      if (is_log_spaced(value, parameter))
        scene.coordinates[int(scene.parameters.all.size())] = {logarithm(), exponential()};
      scene.parameters.all.push_back(parameter);
    });
  }
}

} // namespace rbvi
