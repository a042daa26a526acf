#include "rbvi/core/formula.hpp"

#include "rbvi/core/text.hpp"

#include <algorithm>
#include <array>
#include <set>

namespace rbvi {

namespace {

const std::vector<std::string> coordinates{"x", "y", "z", "nx", "ny", "nz"};
constexpr std::size_t most_values = 96; ///< names and lets of one formula
constexpr int version = 1;

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

/// The text of the values, the lets and the names, with the positions of the parameters.
Record record_of_formula(const Formula &formula) {
  const Formula own = without_idle(formula);
  Record record{"expression", version};
  for (std::size_t i = 0; i < own.values.size(); ++i)
    record.texts["value_" + std::to_string(i)] = own.values[i].text();
  for (std::size_t i = 0; i < own.lets.size(); ++i)
    record.texts["let_" + std::to_string(i)] = own.lets[i].name + " = " + own.lets[i].value.text();
  record.texts["parameters"] = joined(own.parameters, " ");
  std::vector<double> &positions = record.numbers["positions"];
  for (const int position : dependence_of(formula))
    positions.push_back(position);
  return record;
}

/// Evaluates the values of a record.
class Evaluator {
public:
  explicit Evaluator(const Record &record) {
    for (const double position : numbers(record, "positions"))
      positions_.push_back(static_cast<std::size_t>(position));
    std::vector<std::string> names = split(text(record, "parameters"), ' ');
    if (names.size() != positions_.size())
      throw bad_input("a function of the file has other parameters than positions of them");
    first_ = names.size();
    names.insert(names.end(), coordinates.begin(), coordinates.end());
    for (std::size_t i = 0; record.texts.contains("let_" + std::to_string(i)); ++i) {
      const std::string &line = record.texts.at("let_" + std::to_string(i));
      const std::size_t equals = std::min(line.find(" = "), line.size() - 1);
      lets_.push_back(bound_to(parse_expression(line.substr(equals + 2)), names, {}));
      names.push_back(line.substr(0, equals));
    }
    for (std::size_t i = 0; record.texts.contains("value_" + std::to_string(i)); ++i)
      values_.push_back(
          bound_to(parse_expression(record.texts.at("value_" + std::to_string(i))), names, {}));
    if (names.size() > most_values)
      throw bad_input("an expression uses " + std::to_string(names.size()) +
                      " names and lets: at most " + std::to_string(most_values) + " are possible");
  }

  std::size_t size() const { return values_.size(); }

  /// The first `count` values. x, n: null where the values have none.
  void operator()(const FullMu &mu, const Point *x, const Point *n, std::size_t count,
                  double *results) const {
    std::array<double, most_values> at; // not initialised
    for (std::size_t i = 0; i < first_; ++i)
      at[i] = mu.at(positions_[i]);
    double *next = at.data() + first_;
    for (const Point *point : {x, n})
      for (std::size_t c = 0; c < 3; ++c)
        *next++ = point == nullptr ? 0 : (*point)[c];
    for (const BoundExpression &let : lets_)
      *next++ = let.value(at.data());
    for (std::size_t i = 0; i < count; ++i)
      results[i] = values_[i].value(at.data());
  }

private:
  std::vector<std::size_t> positions_;
  std::size_t first_; ///< where the coordinates begin
  std::vector<BoundExpression> lets_, values_;
};

/// An evaluator of as many values as that.
Evaluator evaluator(const Record &record, std::size_t least, std::size_t most) {
  Evaluator own(record);
  if (own.size() < least || own.size() > most)
    throw bad_input("an expression of the file has " + counted(long(own.size()), "value") +
                    " where " + std::to_string(most) + " are asked for");
  return own;
}

const Maker<Coefficient> coefficient_maker{"expression", version,
                                           [](const Record &of) -> std::function<Coefficient> {
                                             return [own = evaluator(of, 1, 1)](const FullMu &mu) {
                                               double value;
                                               own(mu, nullptr, nullptr, 1, &value);
                                               return value;
                                             };
                                           }};

const Maker<PointValue> value_maker{
    "expression", version, [](const Record &of) -> std::function<PointValue> {
      return [own = evaluator(of, 1, 1)](const FullMu &mu, const Point &x) {
        double value;
        own(mu, &x, nullptr, 1, &value);
        return value;
      };
    }};

const Maker<PointMap> map_maker{
    "expression", version, [](const Record &of) -> std::function<PointMap> {
      return [own = evaluator(of, 1, 3)](const FullMu &mu, const Point &x) {
        Point value{};
        own(mu, &x, nullptr, own.size(), value.data());
        return value;
      };
    }};

const Maker<Traction> traction_maker{
    "expression", version, [](const Record &of) -> std::function<Traction> {
      return [own = evaluator(of, 1, 3)](const FullMu &mu, const Point &x, const Point &n) {
        Point value{};
        own(mu, &x, &n, own.size(), value.data());
        return value;
      };
    }};

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

/// The conditions come first, then the values in their messages.
const Maker<Check> check_maker{"expression", version, [](const Record &of) -> std::function<Check> {
                                 const Evaluator own(of);
                                 std::vector<std::string> messages;
                                 for (std::size_t i = 0;
                                      of.texts.contains("message_" + std::to_string(i)); ++i)
                                   messages.push_back(text(of, "message_" + std::to_string(i)));
                                 return [own, messages](const FullMu &mu) {
                                   std::vector<double> values(own.size());
                                   own(mu, nullptr, nullptr, own.size(), values.data());
                                   const double *in_message = values.data() + messages.size();
                                   for (std::size_t i = 0; i < messages.size(); ++i) {
                                     if (!(values[i] != 0) || values[i] != values[i])
                                       throw bad_input(filled(messages[i], in_message));
                                     in_message += std::ranges::count(messages[i], '{');
                                   }
                                 };
                               }};

template <class Signature>
Named<Signature> function_of(const Maker<Signature> &maker, Record record) {
  return {maker.make({record}), record};
}

void check_names(const Formula &formula, const std::vector<std::string> &allowed) {
  const Formula own = without_idle(formula);
  std::vector<std::string> names = own.parameters;
  names.insert(names.end(), allowed.begin(), allowed.end());
  for (const Let &let : own.lets) {
    (void)bound_to(let.value, names, {});
    names.push_back(let.name);
  }
  for (const Expression &value : own.values)
    (void)bound_to(value, names, {});
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

Named<Coefficient> coefficient_of(const Formula &value) {
  check_names(value, {});
  return function_of(coefficient_maker, record_of_formula(value));
}

Named<PointValue> point_value_of(const Formula &value) {
  check_names(value, {"x", "y", "z"});
  return function_of(value_maker, record_of_formula(value));
}

Named<PointMap> point_map_of(const Formula &components) {
  check_names(components, {"x", "y", "z"});
  return function_of(map_maker, record_of_formula(components));
}

Named<Traction> traction_of(const Formula &components) {
  check_names(components, coordinates);
  return function_of(traction_maker, record_of_formula(components));
}

Named<Check> check_of(const Formula &conditions, const std::vector<std::string> &messages) {
  Formula all = conditions;
  for (const std::string &message : messages)
    for (const Expression &value : expressions_in(message))
      all.values.push_back(value);
  check_names(all, {});
  Record record = record_of_formula(all);
  for (std::size_t i = 0; i < messages.size(); ++i)
    record.texts["message_" + std::to_string(i)] = messages[i];
  return function_of(check_maker, std::move(record));
}

FunctionLibrary formula_functions() {
  return {coefficient_maker, value_maker, map_maker, traction_maker, check_maker};
}

} // namespace rbvi
