#include "random_expression.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace rbvi {

RandomText RandomExpressions::operand(RandomText text, int binds_at_least) {
  if (text.binds < binds_at_least || pick(10) == 0)
    return {"(" + text.ours + ")", "(" + text.theirs + ")", 9};
  return text;
}

RandomText RandomExpressions::joined(const RandomText &a, const std::string &operation,
                                     const RandomText &b) {
  static const std::map<std::string, int> binds_of{
      {"or", 1}, {"and", 2}, {"<", 4}, {"<=", 4}, {">", 4}, {">=", 4}, {"==", 4},
      {"!=", 4}, {"+", 5},   {"-", 5}, {"*", 6},  {"/", 6}, {"^", 8}};
  const int binds = binds_of.at(operation);
  const RandomText left = operand(a, binds == 8 ? 9 : binds + (binds == 4)),
                   right = operand(b, binds == 8 ? 7 : binds + 1);
  const std::string space = pick(2) == 0 || binds < 4 ? " " : "";
  const std::string theirs = operation == "or" ? "||" : operation == "and" ? "&&" : operation;
  return {left.ours + space + operation + space + right.ours,
          left.theirs + space + theirs + space + right.theirs, binds};
}

RandomText RandomExpressions::chosen(const RandomText &condition, const RandomText &a,
                                     const RandomText &b) {
  const RandomText c = operand(condition, 1), left = operand(a, 0), right = operand(b, 0);
  return {c.ours + " ? " + left.ours + " : " + right.ours,
          c.theirs + " ? " + left.theirs + " : " + right.theirs, 0};
}

RandomText RandomExpressions::leaf() {
  static const std::vector<std::string> numbers{"0",  "1",   "2",   "3",     "0.5", ".25",
                                                "1.", "1e1", "0.1", "1e-03", "2.75"};
  const std::string text = pick(3) > 0 ? one_of(names_) : one_of(numbers);
  return {text, text, 9};
}

RandomText RandomExpressions::number(int depth) {
  static const std::vector<std::string> sums{"+", "-", "*", "/"},
      functions{"sqrt", "cbrt", "exp",  "log",  "log10", "log2", "sin",  "cos",   "tan", "asin",
                "acos", "atan", "sinh", "cosh", "tanh",  "abs",  "sign", "floor", "ceil"},
      of_two{"atan2", "hypot", "min", "max"};
  if (depth == 0 || pick(8) == 0) return leaf();
  const auto called = [&](const std::string &function, const std::vector<RandomText> &of) {
    RandomText all{function + "(", function + "(", 9};
    for (const RandomText &one : of) {
      const std::string comma = &one == of.data() ? "" : ", ";
      all.ours += comma + one.ours;
      all.theirs += comma + one.theirs;
    }
    all.ours += ")";
    all.theirs += ")";
    return all;
  };
  const int kind = pick(12);
  if (kind < 5) return joined(number(depth - 1), one_of(sums), number(depth - 1));
  if (kind == 5) {
    const std::string n = std::to_string(pick(6));
    const RandomText exponent = pick(2) == 0 ? number(depth - 1) : RandomText{n, n, 9};
    return joined(number(depth - 1), "^", exponent);
  }
  if (kind == 6) {
    const RandomText of = operand(number(depth - 1), 8);
    return {"-" + of.ours, "-" + of.theirs, 7};
  }
  if (kind < 9) return called(one_of(functions), {number(depth - 1)});
  if (kind == 9) return called(one_of(of_two), {number(depth - 1), number(depth - 1)});
  if (kind == 10) return chosen(truth(depth - 1), number(depth - 1), number(depth - 1));
  return pick(3) == 0 ? truth(depth - 1)
                      : called(pick(2) == 0 ? "min" : "max",
                               {number(depth - 1), number(depth - 1), number(depth - 1)});
}

RandomText RandomExpressions::truth(int depth) {
  static const std::vector<std::string> comparisons{"<", "<=", ">", ">=", "==", "!="};
  const int kind = depth == 0 ? 0 : pick(6);
  if (kind < 3)
    return joined(number(std::max(0, depth - 1)), one_of(comparisons),
                  number(std::max(0, depth - 1)));
  if (kind == 3) { // muParser has no word for it
    const RandomText of = operand(truth(depth - 1), 3);
    return {"not " + of.ours, "((" + of.theirs + ") == 0)", 3};
  }
  return joined(truth(depth - 1), kind == 4 ? "and" : "or", truth(depth - 1));
}

namespace {

double applied_here(Operation operation, double a, double b, double c) {
  using enum Operation;
  // clang-format off
  switch (operation) {
  case number: case name: return a;
  case negate: return -a;
  case negation: return a == 0;
  case sqrt: return std::sqrt(a);
  case cbrt: return std::cbrt(a);
  case exp: return std::exp(a);
  case log: return std::log(a);
  case log10: return std::log10(a);
  case log2: return std::log2(a);
  case sin: return std::sin(a);
  case cos: return std::cos(a);
  case tan: return std::tan(a);
  case asin: return std::asin(a);
  case acos: return std::acos(a);
  case atan: return std::atan(a);
  case sinh: return std::sinh(a);
  case cosh: return std::cosh(a);
  case tanh: return std::tanh(a);
  case abs: return std::abs(a);
  case sign: return (a > 0) - (a < 0);
  case floor: return std::floor(a);
  case ceil: return std::ceil(a);
  case add: return a + b;
  case subtract: return a - b;
  case multiply: return a * b;
  case divide: return a / b;
  case power: return std::pow(a, b);
  case less: return a < b;
  case at_most: return a <= b;
  case greater: return a > b;
  case at_least: return a >= b;
  case equal: return a == b;
  case different: return a != b;
  case both: return a != 0 && b != 0;
  case either: return a != 0 || b != 0;
  case atan2: return std::atan2(a, b);
  case min: return std::min(a, b);
  case max: return std::max(a, b);
  case hypot: return std::hypot(a, b);
  case choose: return c != 0 ? b : a;
  }
  // clang-format on
  return 0;
}

constexpr double undecided = std::numeric_limits<double>::infinity();

BoundedValue with_error(Operation operation, const std::array<BoundedValue, 3> &of) {
  using enum Operation;
  const auto at = [&](int moved, double by) {
    const auto operand = [&](int i) {
      return of[static_cast<std::size_t>(i)].value +
             (i == moved ? by * of[static_cast<std::size_t>(i)].error : 0);
    };
    return applied_here(operation, operand(0), operand(1), operand(2));
  };
  const double value = at(-1, 0), epsilon = std::numeric_limits<double>::epsilon();
  // An integer power may be a product.
  double error =
      std::isfinite(value) ? (operation == power ? 20 : 4) * epsilon * std::abs(value) : 0;
  for (int i = 0; i < operands_of(operation); ++i) {
    const BoundedValue &one = of[static_cast<std::size_t>(i)];
    if (operation == choose && i < 2 && i != (of[2].value != 0)) continue;
    const bool ordered = operation == min || operation == max || operation == sign;
    const bool periodic = operation == sin || operation == cos || operation == tan;
    // The sign of a zero is round-off.
    const bool by_sign_of_zero = (operation == divide && of[1].value == 0) ||
                                 (operation == power && of[0].value == 0 && of[1].value < 0) ||
                                 (operation == atan2 && of[0].value == 0 && of[1].value <= 0);
    if (one.error == undecided || by_sign_of_zero || (ordered && std::isnan(one.value)) ||
        (periodic && one.error > 0.01))
      return {value, undecided};
    if (one.error == 0) continue;
    for (const double by : {-1.0, 1.0}) {
      const double moved = at(i, by);
      if (std::isfinite(moved) != std::isfinite(value)) return {value, undecided};
      if (std::isfinite(value)) error = std::max(error, 4 * std::abs(moved - value));
    }
  }
  return {value, error};
}

} // namespace

BoundedValue bounded(const Expression &expression, const std::vector<double> &values) {
  std::vector<BoundedValue> stack;
  bool all_finite = true;
  for (const Instruction &step : expression.program()) {
    std::array<BoundedValue, 3> of{};
    const int count = operands_of(step.operation);
    std::copy(stack.end() - count, stack.end(), of.begin());
    stack.resize(stack.size() - static_cast<std::size_t>(count));
    if (step.operation == Operation::number)
      stack.push_back({step.number, 0});
    else if (step.operation == Operation::name)
      stack.push_back({values[static_cast<std::size_t>(step.name)], 0});
    else
      stack.push_back(with_error(step.operation, of));
    all_finite &= std::isfinite(stack.back().value);
  }
  stack.back().all_finite = all_finite;
  return stack.back();
}

} // namespace rbvi
