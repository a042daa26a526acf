#include "reader.hpp"

#include "rbvi/core/text.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

const CaseNode &section(const Reader &reader, const std::string &name) {
  static const CaseNode none;
  const CaseNode *found = reader.root.find(name);
  return found == nullptr ? none : *found;
}

Expression expression_in(const Reader &reader, const CaseNode &node) {
  if (!node.is_value() || node.value.empty())
    throw bad_input("a number or an expression belongs here");
  try {
    return parse_expression(node.value);
  } catch (const Error &error) {
    // "205 GPa" is no expression.
    if (std::isdigit(static_cast<unsigned char>(node.value[node.value[0] == '-' ? 1 : 0])) == 0)
      throw;
    try {
      const Quantity quantity = parse_quantity(node.value, reader.units);
      return Expression({{Operation::number, 0, quantity.value}}, {});
    } catch (const Error &of_quantity) {
      const bool has_words = node.value.find(' ') != std::string::npos;
      throw bad_input(has_words ? of_quantity.what() : error.what());
    }
  }
}

bool is_name(const std::string &text) {
  try {
    const Expression whole = parse_expression(text);
    return whole.program().size() == 1 && whole.free_names() == std::vector{text};
  } catch (const Error &) {
    return false;
  }
}

bool is_constant(const CaseNode &parameter) {
  return parameter.find("range") == nullptr && parameter.find("values") == nullptr;
}

std::string unit_of(const CaseNode &parameter) {
  if (const CaseNode *unit = parameter.find("unit")) return unit->value;
  for (const char *key : {"default", "range", "limits"})
    if (const CaseNode *numbers = parameter.find(key))
      for (const CaseNode &one :
           numbers->items.empty() ? std::vector<CaseNode>{*numbers} : numbers->items)
        if (const std::string unit = unit_behind(one.value); !unit.empty()) return unit;
  return "";
}

double size_of(const Reader &reader, const std::string &unit) {
  return reader.units && !unit.empty() ? from_unit(1, unit, *reader.units) : 1;
}

double number_in(const Reader &reader, const CaseNode &node, const std::string &unit) {
  if (!reader.units || unit.empty()) return number_in(reader, node);
  if (!unit_behind(node.value).empty()) return parse_quantity(node.value, reader.units, unit).value;
  const double value = number_in(reader, node);
  return expression_in(reader, node).free_names().empty() ? value
                                                          : into_unit(value, unit, *reader.units);
}

Range range_in(const Reader &reader, const CaseNode &list, const std::string &unit) {
  (void)numbers_in(reader, list, 2); // two numbers
  return {number_in(reader, list.items[0], unit), number_in(reader, list.items[1], unit)};
}

double number_in(const Reader &reader, const CaseNode &node) {
  const Expression value = expanded(expression_in(reader, node), reader.lets);
  if (!value.constant())
    throw bad_input("'" + node.value + "' has the name " + value.free_names().front() +
                    ": a number belongs here");
  if (!std::isfinite(*value.constant()))
    throw bad_input("'" + node.value + "' is not finite: a number belongs here");
  return *value.constant();
}

double number_or(const Reader &reader, const CaseNode &table, const std::string &name,
                 double otherwise) {
  const CaseNode *node = table.find(name);
  return node == nullptr ? otherwise : number_in(reader, *node);
}

std::vector<double> numbers_in(const Reader &reader, const CaseNode &list, std::size_t count) {
  if (list.kind != CaseNode::Kind::list || list.items.size() != count)
    throw bad_input("a list of " + std::to_string(count) + " numbers belongs here");
  std::vector<double> numbers;
  for (const CaseNode &item : list.items)
    numbers.push_back(number_in(reader, item));
  return numbers;
}

int dimensions_of(const Reader &reader) {
  return section(reader, "physics").value == "solid" ? 3 : 2;
}

Point vector_in(const Reader &reader, const CaseNode &list) {
  const std::vector<double> x =
      numbers_in(reader, list, static_cast<std::size_t>(dimensions_of(reader)));
  return {x[0], x[1], x.size() > 2 ? x[2] : 0};
}

std::string choice_or(const CaseNode &table, const std::string &name, const std::string &otherwise,
                      const std::vector<std::string> &choices) {
  const CaseNode *node = table.find(name);
  if (node == nullptr) return otherwise;
  if (std::ranges::find(choices, node->value) == choices.end())
    throw bad_input(name + " is '" + node->value + "': use one of " + joined(choices));
  return node->value;
}

bool is_yes(const CaseNode &node) {
  if (node.value == "yes" || node.value == "true") return true;
  if (node.value == "no" || node.value == "false") return false;
  throw bad_input("'" + node.value + "': use yes or no");
}

bool yes_or(const CaseNode &table, const std::string &name, bool otherwise) {
  const CaseNode *node = table.find(name);
  return node == nullptr ? otherwise : is_yes(*node);
}

std::vector<std::string> names_in(const CaseNode &node) {
  std::vector<std::string> names;
  if (node.is_value())
    for (const std::string &name : split(node.value, ','))
      names.push_back(trimmed(name));
  for (const CaseNode &item : node.items)
    names.push_back(item.value);
  for (std::size_t i = 0; i < names.size(); ++i) // a name twice is there once
    names.erase(std::remove(names.begin() + std::ptrdiff_t(i) + 1, names.end(), names[i]),
                names.end());
  if (names.empty()) throw bad_input("a name, or a list of names, belongs here");
  return names;
}

const CaseNode &entry(const CaseNode &table, const std::string &name) {
  const CaseNode *found = table.find(name);
  if (found == nullptr) throw bad_input("'" + name + "' is missing");
  return *found;
}

Formula formula_of(Reader &reader, std::vector<Expression> values) {
  Formula formula{std::move(values), reader.lets, reader.values};
  for (const int position : dependence_of(formula))
    reader.used.insert(reader.parameters[static_cast<std::size_t>(position)]);
  return formula;
}

Formula formula_in(Reader &reader, const CaseNode &node) {
  return formula_of(reader, {expression_in(reader, node)});
}

std::vector<Expression> components_in(const Reader &reader, const CaseNode &node) {
  if (node.is_value()) return {expression_in(reader, node)};
  std::vector<Expression> components;
  for (const CaseNode &item : node.items)
    components.push_back(expression_in(reader, item));
  if (components.empty() || components.size() > 3)
    throw bad_input("a list of components, [x, y], belongs here (a comma inside of [ ] begins the "
                    "next one: quote expressions that have commas)");
  return components;
}

Factor factor_of(Reader &reader, const Expression &value) {
  const Formula formula = formula_of(reader, {value});
  return {expanded(value, reader.lets).text(), coefficient_of(formula), dependence_of(formula)};
}

namespace {

/// What varies in a product, factor by factor, so that terms are known to share one; the rest is
/// multiplied into `constant`.
void split_product(const Program &product, const std::vector<std::string> &names,
                   std::vector<Expression> &factors, double &constant) {
  const Expression whole(product, names);
  const Operation last = product.back().operation;
  auto right = product.end() - 1; // where the last operand begins
  for (int wanted = 1; wanted > 0 && right != product.begin();)
    wanted += operands_of((--right)->operation) - 1;
  const Program left(product.begin(), right), of_right(right, product.end() - 1);
  if (const std::optional<double> value = whole.constant()) {
    constant *= *value;
  } else if (last == Operation::negate) {
    constant = -constant;
    split_product(of_right, names, factors, constant);
  } else if (last == Operation::multiply) {
    split_product(left, names, factors, constant);
    split_product(of_right, names, factors, constant);
  } else if (last == Operation::divide) {
    split_product(left, names, factors, constant);
    Program inverse{{Operation::number, 0, 1}};
    inverse.insert(inverse.end(), right, product.end());
    const Expression under(of_right, names);
    if (under.constant())
      constant /= *under.constant();
    else
      factors.emplace_back(inverse, names);
  } else {
    factors.push_back(whole);
  }
}

} // namespace

std::optional<std::vector<Product>> products_of(Reader &reader, const Expression &value) {
  const Expression whole = expanded(value, reader.lets);
  const auto sum = separated(whole, reader.values);
  if (!sum) return std::nullopt;
  std::vector<Product> products;
  for (const auto &[in_parameters, at_point] : *sum) {
    if (in_parameters.constant() == 0 || at_point.constant() == 0) continue;
    Product product{{}, at_point};
    std::vector<Expression> factors;
    double constant = 1;
    split_product(in_parameters.program(), in_parameters.free_names(), factors, constant);
    if (constant != 1) factors.push_back(Expression({{Operation::number, 0, constant}}, {}));
    for (const Expression &factor : factors)
      product.factors.push_back(factor_of(reader, factor));
    products.push_back(std::move(product));
  }
  return products;
}

} // namespace rbvi
