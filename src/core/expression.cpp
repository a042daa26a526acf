#include "rbvi/core/expression.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace rbvi {

namespace {

constexpr int stack_size = 64;

/// work(f, df): f(x), and its derivative df(x, f(x)).
template <class Work> void with_unary(Operation operation, Work &&work) {
  using enum Operation;
  const auto flat = [](double, double) { return 0.0; };
  // clang-format off
  switch (operation) {
  case negate: return work([](double x) { return -x; }, [](double, double) { return -1.0; });
  case negation: return work([](double x) { return double(x == 0); }, flat);
  case sqrt: return work([](double x) { return std::sqrt(x); }, [](double, double f) { return 0.5 / f; });
  case cbrt: return work([](double x) { return std::cbrt(x); }, [](double, double f) { return 1 / (3 * f * f); });
  case exp: return work([](double x) { return std::exp(x); }, [](double, double f) { return f; });
  case log: return work([](double x) { return std::log(x); }, [](double x, double) { return 1 / x; });
  case log10: return work([](double x) { return std::log10(x); }, [](double x, double) { return std::numbers::log10e / x; });
  case log2: return work([](double x) { return std::log2(x); }, [](double x, double) { return std::numbers::log2e / x; });
  case sin: return work([](double x) { return std::sin(x); }, [](double x, double) { return std::cos(x); });
  case cos: return work([](double x) { return std::cos(x); }, [](double x, double) { return -std::sin(x); });
  case tan: return work([](double x) { return std::tan(x); }, [](double, double f) { return 1 + f * f; });
  case asin: return work([](double x) { return std::asin(x); }, [](double x, double) { return 1 / std::sqrt((1 - x) * (1 + x)); });
  case acos: return work([](double x) { return std::acos(x); }, [](double x, double) { return -1 / std::sqrt((1 - x) * (1 + x)); });
  case atan: return work([](double x) { return std::atan(x); }, [](double x, double) { return 1 / (1 + x * x); });
  case sinh: return work([](double x) { return std::sinh(x); }, [](double x, double) { return std::cosh(x); });
  case cosh: return work([](double x) { return std::cosh(x); }, [](double x, double) { return std::sinh(x); });
  case tanh: return work([](double x) { return std::tanh(x); }, [](double, double f) { return 1 - f * f; });
  case abs: return work([](double x) { return std::abs(x); }, [](double x, double) { return x < 0 ? -1.0 : 1.0; });
  case sign: return work([](double x) { return x > 0 ? 1.0 : x < 0 ? -1.0 : x; }, flat);
  case floor: return work([](double x) { return std::floor(x); }, flat);
  default: return work([](double x) { return std::ceil(x); }, flat);
  }
  // clang-format on
}

using Pair = std::pair<double, double>;

double power_of(double a, double b) {
  return b == 2 ? a * a : std::pow(a, b);
}

Pair slopes_of_power(double a, double b, double f) {
  return {b == 0 ? 0 : b * power_of(a, b - 1), a == 0 && b > 0 ? 0 : std::log(a) * f};
}

/// NaN where one is.
bool first_is_least(double a, double b) {
  return a <= b || std::isnan(a);
}
bool first_is_largest(double a, double b) {
  return a >= b || std::isnan(a);
}

/// work(f, df): f(a, b), and its partial derivatives df(a, b, f(a, b)).
template <class Work> void with_binary(Operation operation, Work &&work) {
  using enum Operation;
  const auto flat = [](double, double, double) { return Pair(0, 0); };
  // clang-format off
  switch (operation) {
  case add: return work([](double a, double b) { return a + b; }, [](double, double, double) { return Pair(1, 1); });
  case subtract: return work([](double a, double b) { return a - b; }, [](double, double, double) { return Pair(1, -1); });
  case multiply: return work([](double a, double b) { return a * b; }, [](double a, double b, double) { return Pair(b, a); });
  case divide: return work([](double a, double b) { return a / b; }, [](double, double b, double f) { return Pair(1 / b, -f / b); });
  case power: return work(power_of, slopes_of_power);
  case less: return work([](double a, double b) { return double(a < b); }, flat);
  case at_most: return work([](double a, double b) { return double(a <= b); }, flat);
  case greater: return work([](double a, double b) { return double(a > b); }, flat);
  case at_least: return work([](double a, double b) { return double(a >= b); }, flat);
  case equal: return work([](double a, double b) { return double(a == b); }, flat);
  case different: return work([](double a, double b) { return double(a != b); }, flat);
  case both: return work([](double a, double b) { return double(a != 0 && b != 0); }, flat);
  case either: return work([](double a, double b) { return double(a != 0 || b != 0); }, flat);
  case atan2: return work([](double a, double b) { return std::atan2(a, b); },
                          [](double a, double b, double) { return Pair(b / (a * a + b * b), -a / (a * a + b * b)); });
  case min: return work([](double a, double b) { return first_is_least(a, b) ? a : b; },
                        [](double a, double b, double) { return first_is_least(a, b) ? Pair(1, 0) : Pair(0, 1); });
  case max: return work([](double a, double b) { return first_is_largest(a, b) ? a : b; },
                        [](double a, double b, double) { return first_is_largest(a, b) ? Pair(1, 0) : Pair(0, 1); });
  default: return work([](double a, double b) { return std::hypot(a, b); },
                       [](double a, double b, double f) { return f == 0 ? Pair(0, 0) : Pair(a / f, b / f); });
  }
  // clang-format on
}

/// Values at some points.
template <int points> struct Lanes {
  std::array<double, points> of;
  template <class F, class Slope> void map(const F &f, const Slope &) {
    for (double &x : of)
      x = f(x);
  }
  template <class F, class Slopes> void join(const Lanes &other, const F &f, const Slopes &) {
    for (int i = 0; i < points; ++i)
      of[i] = f(of[i], other.of[i]);
  }
  void choose(const Lanes &if_so, const Lanes &condition) {
    for (int i = 0; i < points; ++i)
      of[i] = condition.of[i] != 0 ? if_so.of[i] : of[i];
  }
};

/// A value with some of its derivatives. What does not vary adds none, even by an infinite slope.
struct Varied {
  double value;
  std::array<double, 8> by;
  template <class F, class Slope> void map(const F &f, const Slope &slope) {
    const double x = std::exchange(value, f(value)), factor = slope(x, value);
    for (double &d : by)
      d = d == 0 ? 0 : factor * d;
  }
  template <class F, class Slopes> void join(const Varied &b, const F &f, const Slopes &slopes) {
    const double a = std::exchange(value, f(value, b.value));
    const Pair factors = slopes(a, b.value, value);
    for (std::size_t i = 0; i < by.size(); ++i)
      by[i] =
          (by[i] == 0 ? 0 : factors.first * by[i]) + (b.by[i] == 0 ? 0 : factors.second * b.by[i]);
  }
  void choose(const Varied &if_so, const Varied &condition) {
    if (condition.value != 0) *this = if_so;
  }
};

/// load(instruction, target): of a number or a name.
template <class Value, class Load> Value run(const Program &program, const Load &load) {
  std::array<Value, stack_size> stack; // not initialised
  Value *top = stack.data();           // behind the last
  for (const Instruction &step : program) {
    const int operands = operands_of(step.operation);
    if (operands == 0) load(step, *top++);
    if (operands == 1) with_unary(step.operation, [&](const auto &...f) { top[-1].map(f...); });
    if (operands == 2) {
      --top;
      with_binary(step.operation, [&](const auto &...f) { top[-1].join(*top, f...); });
    }
    if (operands == 3) {
      top -= 2;
      top[-1].choose(top[0], top[1]);
    }
  }
  return stack[0];
}

template <int points>
Lanes<points> run_at(const Program &program, const double *columns, std::size_t stride) {
  return run<Lanes<points>>(program, [&](const Instruction &step, Lanes<points> &target) {
    const bool named = step.operation == Operation::name;
    const double *column = columns + static_cast<std::size_t>(step.name) * stride;
    for (int i = 0; i < points; ++i)
      target.of[i] = named ? column[i] : step.number;
  });
}

std::size_t position(const std::vector<std::string> &names, const std::string &name,
                     const std::string &text) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw bad_input("unknown name '" + name + "' in '" + text + "'" +
                    (names.empty() ? ": no name is known here"
                                   : ": the nearest is '" + nearest_name(name, names) + "'"));
  return static_cast<std::size_t>(found - names.begin());
}

} // namespace

int operands_of(Operation operation) {
  return operation < Operation::negate ? 0
         : operation < Operation::add  ? 1
                                       : 2 + (operation == Operation::choose);
}

Expression::Expression(Program program, const std::vector<std::string> &names)
    : program_(std::move(program)) {
  std::map<std::string, int> used;
  int depth = 0;
  for (const Instruction &step : program_) {
    if (step.operation == Operation::name) used[names[step.name]];
    depth += 1 - operands_of(step.operation);
    if (depth > stack_size)
      throw bad_input("an expression has to keep more than " + std::to_string(stack_size) +
                      " numbers at once: write operands that are long first");
  }
  for (auto &[name, place] : used) {
    place = static_cast<int>(names_.size());
    names_.push_back(name);
  }
  for (Instruction &step : program_)
    if (step.operation == Operation::name) step.name = used[names[step.name]];
}

std::optional<double> Expression::constant() const {
  if (!names_.empty()) return std::nullopt;
  return run_at<1>(program_, nullptr, 0).of[0];
}

BoundExpression bound_to(const Expression &expression, const std::vector<std::string> &names,
                         const std::vector<std::string> &by) {
  BoundExpression bound;
  bound.program_ = expression.program();
  for (Instruction &step : bound.program_)
    if (step.operation == Operation::name)
      step.name =
          static_cast<int>(position(names, expression.free_names()[step.name], expression.text()));
  bound.slots_.assign(names.size(), -1);
  for (const std::string &name : by)
    bound.slots_[position(names, name, "the names of a gradient")] = bound.gradient_size_++;
  return bound;
}

BoundExpression bound_to(const Expression &expression, const std::vector<std::string> &names) {
  return bound_to(expression, names, names);
}

double BoundExpression::value(const double *values) const {
  return run_at<1>(program_, values, 1).of[0];
}

void BoundExpression::value_and_gradient(const double *values, double &value,
                                         double *gradient) const {
  int first = 0;
  do {
    const Varied result = run<Varied>(program_, [&](const Instruction &step, Varied &target) {
      target = {step.number, {}};
      if (step.operation == Operation::number) return;
      target.value = values[step.name];
      const int slot = slots_[step.name] - first;
      if (slot >= 0 && slot < 8) target.by[slot] = 1;
    });
    value = result.value;
    std::copy_n(result.by.begin(), std::min(8, gradient_size_ - first), gradient + first);
    first += 8;
  } while (first < gradient_size_);
}

void BoundExpression::values(const double *columns, std::size_t count, double *results) const {
  constexpr std::size_t width = 32;
  std::size_t i = 0;
  for (; i + width <= count; i += width) {
    const Lanes<width> result = run_at<width>(program_, columns + i, count);
    std::copy_n(result.of.begin(), width, results + i);
  }
  for (; i < count; ++i)
    results[i] = run_at<1>(program_, columns + i, count).of[0];
}

} // namespace rbvi
