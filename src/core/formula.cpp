#include "rbvi/core/formula.hpp"

#include "rbvi/core/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

namespace rbvi {

namespace {

const std::vector<std::string> coordinates{"x", "y", "z", "nx", "ny", "nz"};
constexpr std::size_t most_parameters = 64; ///< of one formula

/// What the values use: their lets with what these use, and the parameters, in their order.
Formula without_idle(const Formula &formula) {
  std::set<std::string> used;
  const auto use = [&](const Expression &expression) {
    used.insert(expression.free_names().begin(), expression.free_names().end());
  };
  for (const Expression &value : formula.values)
    use(value);
  Formula own{formula.values};
  for (auto let = formula.lets.rbegin(); let != formula.lets.rend(); ++let) {
    if (!used.contains(let->name)) continue;
    use(let->value);
    own.lets.insert(own.lets.begin(), *let);
  }
  for (const std::string &name : formula.parameters)
    if (used.contains(name)) own.parameters.push_back(name);
  return own;
}

/// So many of the coordinates.
std::vector<std::string> first(long count) {
  return {coordinates.begin(), coordinates.begin() + count};
}

/// `at`: names that the values may have beside those of parameters; `by`: of gradients. Throws
/// bad_input for a formula of too many parameters.
BoundProgram program_of(const Formula &formula, const std::vector<std::string> &at,
                        const std::vector<std::string> &by) {
  const Formula own = without_idle(formula);
  if (own.parameters.size() > most_parameters)
    throw bad_input("a formula depends on more than " + std::to_string(most_parameters) +
                    " parameters");
  Lets lets;
  for (const auto &[name, value] : own.lets)
    lets.emplace_back(name, value);
  return bound_program(lets, own.values, own.parameters, at, by);
}

/// Evaluates the values of a formula at a point.
class Evaluator {
public:
  Evaluator(const Formula &formula, const std::vector<std::string> &at,
            const std::vector<std::string> &by = {})
      : size_(formula.values.size()), program_(program_of(formula, at, by)) {
    for (const int position : dependence_of(formula))
      positions_.push_back(static_cast<std::size_t>(position));
  }

  std::size_t size() const { return size_; }

  /// At `count` points; coordinates and results column by column.
  void operator()(const FullMu &mu, const double *at, double *results,
                  std::size_t count = 1) const {
    std::array<double, most_parameters> parameters; // not initialised
    put(mu, parameters);
    program_.values(parameters.data(), at, count, results);
  }
  /// The gradients stand behind the values.
  void with_gradient(const FullMu &mu, const double *at, double *results) const {
    std::array<double, most_parameters> parameters;
    put(mu, parameters);
    program_.values_and_gradients(parameters.data(), at, 1, results, results + size_);
  }

private:
  void put(const FullMu &mu, std::array<double, most_parameters> &parameters) const {
    for (std::size_t i = 0; i < positions_.size(); ++i)
      parameters[i] = mu.at(positions_[i]);
  }
  std::size_t size_;
  BoundProgram program_;
  std::vector<std::size_t> positions_;
};

struct ExpressionMap {
  Evaluator own;
  Point operator()(const FullMu &mu, const Point &x) const {
    Point value{};
    own(mu, x.data(), value.data());
    return value;
  }
};

/// "the radius {r}" -> "the radius 0.2", from the values in their order.
std::string filled(const std::string &message, const double *values) {
  std::string text;
  std::size_t begin = 0;
  for (std::size_t open = message.find('{'); open != std::string::npos;
       open = message.find('{', begin)) {
    const std::size_t close = std::min(message.find('}', open), message.size() - 1);
    text += message.substr(begin, open - begin) + short_number(*values++);
    begin = close + 1;
  }
  return text + message.substr(begin);
}

/// The expressions in a message.
std::vector<Expression> expressions_in(const std::string &message) {
  std::vector<Expression> all;
  for (std::size_t open = message.find('{'); open != std::string::npos;
       open = message.find('{', open + 1)) {
    const std::size_t close = message.find('}', open);
    if (close == std::string::npos) throw bad_input("'{' of a message is not closed");
    all.push_back(parse_expression(message.substr(open + 1, close - open - 1)));
  }
  return all;
}

void check_names(const Formula &formula, const std::vector<std::string> &allowed) {
  const Formula own = without_idle(formula);
  std::vector<std::string> names = formula.parameters;
  names.insert(names.end(), allowed.begin(), allowed.end());
  for (const Expression &value : own.values)
    for (const std::string &name : value.free_names())
      if (is_coordinate(name) && std::ranges::find(names, name) == names.end())
        throw bad_input("unknown name '" + name + "' in '" + value.text() +
                        "': this number has no place, it may have parameters");
  for (const Let &let : own.lets) {
    (void)bound_to(let.value, names, {});
    names.push_back(let.name);
  }
  for (const Expression &value : own.values)
    (void)bound_to(value, names, {});
}

/// Whether an operation keeps what is smooth so: of others no few points tell what they are.
bool is_rational(Operation operation) {
  using enum Operation;
  return operation == number || operation == name || operation == negate || operation == add ||
         operation == subtract || operation == multiply || operation == divide;
}

/// f(0) and f' of an expression in one name that is affine.
std::optional<std::pair<double, double>> affine_of(const Expression &whole) {
  if (whole.free_names().size() != 1 ||
      !std::ranges::all_of(whole.program(), is_rational, &Instruction::operation))
    return std::nullopt;
  const BoundExpression bound = bound_to(whole, whole.free_names());
  double at_zero = 0, slope = 0;
  const double zero = 0;
  bound.value_and_gradient(&zero, at_zero, &slope);
  for (const double x : {1.0, -3.0, 0.37, 1e3}) {
    double value = 0, own = 0;
    bound.value_and_gradient(&x, value, &own);
    if (!(own == slope) || !(std::abs(value - at_zero - slope * x) <=
                             1e-15 * (std::abs(at_zero) + std::abs(slope * x))))
      return std::nullopt;
  }
  return std::pair(at_zero, slope);
}

} // namespace

bool is_coordinate(const std::string &name) {
  return std::ranges::find(coordinates, name) != coordinates.end();
}

std::vector<int> dependence_of(const Formula &formula) {
  std::vector<int> positions;
  for (const std::string &name : without_idle(formula).parameters)
    positions.push_back(
        static_cast<int>(std::ranges::find(formula.parameters, name) - formula.parameters.begin()));
  return positions;
}

bool depends_on_point(const Formula &formula) {
  const Formula own = without_idle(formula);
  const auto on_point = [](const Expression &value) {
    return std::ranges::any_of(value.free_names(), is_coordinate);
  };
  return std::ranges::any_of(own.values, on_point) ||
         std::ranges::any_of(own.lets, [&](const Let &let) { return on_point(let.value); });
}

Expression expanded(const Expression &expression, const std::vector<Let> &lets) {
  std::vector<Let> own; // each with the lets before it written out
  const auto expand = [&own](const Expression &value) {
    std::vector<std::string> names = value.free_names();
    Program program;
    for (Instruction step : value.program()) {
      const auto let = step.operation != Operation::name
                           ? own.end()
                           : std::ranges::find(own, value.free_names()[step.name], &Let::name);
      if (let == own.end()) {
        program.push_back(step);
        continue;
      }
      for (Instruction inner : let->value.program()) {
        if (inner.operation == Operation::name) {
          names.push_back(let->value.free_names()[inner.name]);
          inner.name = static_cast<int>(names.size()) - 1;
        }
        program.push_back(inner);
      }
    }
    return Expression(std::move(program), names);
  };
  for (const Let &let : lets)
    own.push_back({let.name, expand(let.value)});
  return expand(expression);
}

std::function<Coefficient> coefficient_of(const Formula &value) {
  check_names(value, {});
  const Expression whole = expanded(value.values.front(), value.lets);
  if (whole.constant()) return constant(*whole.constant());
  if (const auto line = affine_of(whole))
    return affine(line->first, line->second, dependence_of(value).front());
  return [own = Evaluator(value, {})](const FullMu &mu) {
    double result;
    own(mu, nullptr, &result);
    return result;
  };
}

std::function<PointValue> point_value_of(const Formula &value) {
  check_names(value, {"x", "y", "z"});
  if (!depends_on_point(value)) return everywhere(coefficient_of(value));
  return [own = Evaluator(value, first(3))](const FullMu &mu, const Point &x) {
    double result;
    own(mu, x.data(), &result);
    return result;
  };
}

std::function<PointMap> point_map_of(const Formula &components) {
  check_names(components, {"x", "y", "z"});
  if (!depends_on_point(components)) {
    std::vector<std::function<Coefficient>> own;
    for (const Expression &value : components.values) {
      Formula one = components;
      one.values = {value};
      own.push_back(coefficient_of(one));
    }
    return everywhere(own);
  }
  return ExpressionMap{Evaluator(components, first(3))};
}

std::function<PointMap> value_and_gradient_of(const Formula &value) {
  check_names(value, first(3));
  return [own = Evaluator(value, first(3), first(2))](const FullMu &mu, const Point &x) {
    Point result{};
    own.with_gradient(mu, x.data(), result.data());
    return result;
  };
}

std::function<PointMap> gradient_of(const Formula &value) {
  check_names(value, first(3));
  return [own = Evaluator(value, first(3), first(3))](const FullMu &mu, const Point &x) {
    std::array<double, 4> result;
    own.with_gradient(mu, x.data(), result.data());
    return Point{result[1], result[2], result[3]};
  };
}

std::function<Traction> traction_of(const Formula &components) {
  check_names(components, coordinates);
  return
      [own = Evaluator(components, coordinates)](const FullMu &mu, const Point &x, const Point &n) {
        const std::array at{x[0], x[1], x[2], n[0], n[1], n[2]};
        Point value{};
        own(mu, at.data(), value.data());
        return value;
      };
}

std::function<Check> check_of(const Formula &conditions, const std::vector<std::string> &messages) {
  Formula all = conditions; // then the values in their messages
  for (const std::string &message : messages)
    for (const Expression &value : expressions_in(message))
      all.values.push_back(value);
  check_names(all, {});
  return [own = Evaluator(all, {}), messages](const FullMu &mu) {
    std::vector<double> values(own.size());
    own(mu, nullptr, values.data());
    const double *in_message = values.data() + messages.size();
    for (std::size_t i = 0; i < messages.size(); ++i) {
      if (!(values[i] != 0) || values[i] != values[i])
        throw bad_input(filled(messages[i], in_message));
      in_message += std::ranges::count(messages[i], '{');
    }
  };
}

std::vector<Point> images(const std::function<PointMap> &map, const FullMu &mu,
                          const std::vector<Point> &points) {
  const std::size_t count = points.size();
  std::vector<Point> result(count);
  const auto *many = map.target<ExpressionMap>();
  if (many == nullptr) {
    for (std::size_t i = 0; i < count; ++i)
      result[i] = map(mu, points[i]);
    return result;
  }
  std::vector<double> at(3 * count), values(many->own.size() * count);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t c = 0; c < 3; ++c)
      at[c * count + i] = points[i][c];
  many->own(mu, at.data(), values.data(), count);
  for (std::size_t c = 0; c < many->own.size(); ++c)
    for (std::size_t i = 0; i < count; ++i)
      result[i][c] = values[c * count + i];
  return result;
}

std::function<FieldValues> field_values_of(const Formula &values) {
  check_names(values, output_fields());
  return [own = Evaluator(values, output_fields())](const FullMu &mu, const double *fields,
                                                    std::size_t count, double *results) {
    own(mu, fields, results, count);
  };
}

} // namespace rbvi
