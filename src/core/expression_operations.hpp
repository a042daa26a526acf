// What the operations of expressions are, and their derivatives.
#pragma once

#include "rbvi/core/expression.hpp"

#include <cmath>
#include <numbers>

namespace rbvi {

using SlopePair = std::pair<double, double>;

inline double power_of(double a, double b) {
  return b == 2 ? a * a : std::pow(a, b);
}

inline SlopePair slopes_of_power(double a, double b, double f) {
  return {b == 0 ? 0 : b * power_of(a, b - 1), a == 0 && b > 0 ? 0 : std::log(a) * f};
}

/// Squares that neither overflow nor lose digits need no std::hypot, which takes several times
/// longer.
inline double hypot_of(double a, double b) {
  const double square = a * a + b * b;
  return square > 1e-280 && square < 1e280 ? std::sqrt(square) : std::hypot(a, b);
}

/// NaN where one is.
inline bool first_is_least(double a, double b) {
  return a <= b || std::isnan(a);
}
inline bool first_is_largest(double a, double b) {
  return a >= b || std::isnan(a);
}

/// Calls one of work.unary(f, df): f(x), and its derivative df(x, f(x)); work.binary(f, df): f(a,
/// b), and its partial derivatives df(a, b, f(a, b)); work.jump(f): f(x) or f(a, b) of slope 0;
/// work.pick(first): a if first(a, b), else b; work.choose().
template <class Work>
[[gnu::always_inline]] inline void with_operation(Operation operation, const Work &work) {
  using enum Operation;
  using Pair = SlopePair;
  // clang-format off
  switch (operation) {
  case negate: return work.unary([](double x) { return -x; }, [](double, double) { return -1.0; });
  case negation: return work.jump([](double x) { return double(x == 0); });
  case sqrt: return work.unary([](double x) { return std::sqrt(x); }, [](double, double f) { return 0.5 / f; });
  case cbrt: return work.unary([](double x) { return std::cbrt(x); }, [](double, double f) { return 1 / (3 * f * f); });
  case exp: return work.unary([](double x) { return std::exp(x); }, [](double, double f) { return f; });
  case log: return work.unary([](double x) { return std::log(x); }, [](double x, double) { return 1 / x; });
  case log10: return work.unary([](double x) { return std::log10(x); }, [](double x, double) { return std::numbers::log10e / x; });
  case log2: return work.unary([](double x) { return std::log2(x); }, [](double x, double) { return std::numbers::log2e / x; });
  case sin: return work.unary([](double x) { return std::sin(x); }, [](double x, double) { return std::cos(x); });
  case cos: return work.unary([](double x) { return std::cos(x); }, [](double x, double) { return -std::sin(x); });
  case tan: return work.unary([](double x) { return std::tan(x); }, [](double, double f) { return 1 + f * f; });
  case asin: return work.unary([](double x) { return std::asin(x); }, [](double x, double) { return 1 / std::sqrt((1 - x) * (1 + x)); });
  case acos: return work.unary([](double x) { return std::acos(x); }, [](double x, double) { return -1 / std::sqrt((1 - x) * (1 + x)); });
  case atan: return work.unary([](double x) { return std::atan(x); }, [](double x, double) { return 1 / (1 + x * x); });
  case sinh: return work.unary([](double x) { return std::sinh(x); }, [](double x, double) { return std::cosh(x); });
  case cosh: return work.unary([](double x) { return std::cosh(x); }, [](double x, double) { return std::sinh(x); });
  case tanh: return work.unary([](double x) { return std::tanh(x); }, [](double, double f) { return 1 - f * f; });
  case abs: return work.unary([](double x) { return std::abs(x); }, [](double x, double) { return x < 0 ? -1.0 : 1.0; });
  case sign: return work.jump([](double x) { return x > 0 ? 1.0 : x < 0 ? -1.0 : x; });
  case floor: return work.jump([](double x) { return std::floor(x); });
  case ceil: return work.jump([](double x) { return std::ceil(x); });
  case add: return work.binary([](double a, double b) { return a + b; }, [](double, double, double) { return Pair(1, 1); });
  case subtract: return work.binary([](double a, double b) { return a - b; }, [](double, double, double) { return Pair(1, -1); });
  case multiply: return work.binary([](double a, double b) { return a * b; }, [](double a, double b, double) { return Pair(b, a); });
  case divide: return work.binary([](double a, double b) { return a / b; }, [](double, double b, double f) { return Pair(1 / b, -f / b); });
  case power: return work.binary(power_of, slopes_of_power);
  case less: return work.jump([](double a, double b) { return double(a < b); });
  case at_most: return work.jump([](double a, double b) { return double(a <= b); });
  case greater: return work.jump([](double a, double b) { return double(a > b); });
  case at_least: return work.jump([](double a, double b) { return double(a >= b); });
  case equal: return work.jump([](double a, double b) { return double(a == b); });
  case different: return work.jump([](double a, double b) { return double(a != b); });
  case both: return work.jump([](double a, double b) { return double(a != 0 && b != 0); });
  case either: return work.jump([](double a, double b) { return double(a != 0 || b != 0); });
  case atan2: return work.binary([](double a, double b) { return std::atan2(a, b); },
                          [](double a, double b, double) { return Pair(b / (a * a + b * b), -a / (a * a + b * b)); });
  case min: return work.pick(first_is_least);
  case max: return work.pick(first_is_largest);
  case hypot: return work.binary(hypot_of,
                       [](double a, double b, double f) { return f == 0 ? Pair(0, 0) : Pair(a / f, b / f); });
  case choose: return work.choose();
  default: __builtin_unreachable(); // numbers and names are registers
  }
  // clang-format on
}

} // namespace rbvi
