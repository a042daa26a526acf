// What the operations of expressions are, with their derivatives, and how one step of a program
// works on registers of some kinds.
#pragma once

#include "rbvi/core/expression.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <type_traits>

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

template <class Work, class F> void without_slopes(const Work &work, const F &f) {
  if constexpr (std::is_invocable_v<F, double>)
    work.unary(f, 0);
  else
    work.binary(f, 0);
}

/// A register holds a value.
struct ValueStep {
  double *registers;
  const ProgramStep &step;
  template <class F, class Slope> void unary(const F &f, const Slope &) const {
    registers[step.target] = f(registers[step.a]);
  }
  template <class F, class Slopes> void binary(const F &f, const Slopes &) const {
    registers[step.target] = f(registers[step.a], registers[step.b]);
  }
  template <class F> void jump(const F &f) const { without_slopes(*this, f); }
  template <class First> void pick(const First &first) const {
    const double a = registers[step.a], b = registers[step.b];
    registers[step.target] = first(a, b) ? a : b;
  }
  void choose() const {
    registers[step.target] = registers[registers[step.c] != 0 ? step.b : step.a];
  }
};

constexpr int most_registers = 512;
constexpr std::size_t block_size = 32, vector_size = 4;
using Block = std::array<double, block_size>;

/// A register holds the values at some points. That of a result is none of an operand.
struct BlockStep {
  Block *registers;
  std::size_t vectors; ///< of points
  const ProgramStep &step;
  template <class F, class Slope> void unary(const F &f, const Slope &) const {
    double *__restrict to = registers[step.target].data();
    const double *a = registers[step.a].data();
    for (std::size_t i = 0; i < vector_size * vectors; ++i)
      to[i] = f(a[i]);
  }
  template <class F, class Slopes> void binary(const F &f, const Slopes &) const {
    double *__restrict to = registers[step.target].data();
    const double *a = registers[step.a].data(), *b = registers[step.b].data();
    for (std::size_t i = 0; i < vector_size * vectors; ++i)
      to[i] = f(a[i], b[i]);
  }
  template <class F> void jump(const F &f) const { without_slopes(*this, f); }
  template <class First> void pick(const First &first) const {
    binary([&](double a, double b) { return first(a, b) ? a : b; }, 0);
  }
  void choose() const {
    double *__restrict to = registers[step.target].data();
    const double *otherwise = registers[step.a].data(), *if_so = registers[step.b].data(),
                 *condition = registers[step.c].data();
    for (std::size_t i = 0; i < vector_size * vectors; ++i)
      to[i] = condition[i] != 0 ? if_so[i] : otherwise[i];
  }
};

/// Derivatives of a value by some names.
constexpr int slopes_at_once = 4;
using Slopes = std::array<double, slopes_at_once>;

/// A register holds a value with some of its derivatives. What does not vary adds none, even by an
/// infinite slope.
struct VariedStep {
  double *registers;
  Slopes *slopes;
  const ProgramStep &step;
  template <class F, class Slope> void unary(const F &f, const Slope &slope) const {
    const double x = registers[step.a], value = f(x), factor = slope(x, value);
    registers[step.target] = value;
    double *__restrict to = slopes[step.target].data();
    const double *a = slopes[step.a].data();
    for (int i = 0; i < slopes_at_once; ++i) {
      const double product = factor * a[i];
      to[i] = a[i] == 0 ? 0 : product;
    }
  }
  template <class F, class Slopes> void binary(const F &f, const Slopes &slopes_of) const {
    const double x = registers[step.a], y = registers[step.b], value = f(x, y);
    const auto [by_x, by_y] = slopes_of(x, y, value);
    registers[step.target] = value;
    double *__restrict to = slopes[step.target].data();
    const double *a = slopes[step.a].data(), *b = slopes[step.b].data();
    for (int i = 0; i < slopes_at_once; ++i) {
      const double of_a = by_x * a[i], of_b = by_y * b[i];
      to[i] = (a[i] == 0 ? 0 : of_a) + (b[i] == 0 ? 0 : of_b);
    }
  }
  template <class F> void jump(const F &f) const {
    if constexpr (std::is_invocable_v<F, double>)
      registers[step.target] = f(registers[step.a]);
    else
      registers[step.target] = f(registers[step.a], registers[step.b]);
    slopes[step.target] = {};
  }
  void copy(unsigned short from) const {
    registers[step.target] = registers[from];
    slopes[step.target] = slopes[from];
  }
  template <class First> void pick(const First &first) const {
    copy(first(registers[step.a], registers[step.b]) ? step.a : step.b);
  }
  void choose() const { copy(registers[step.c] != 0 ? step.b : step.a); }
};

/// A register holds the values and some derivatives at some points.
struct VariedBlockStep {
  Block *registers;
  std::array<Block, slopes_at_once> *slopes;
  std::array<bool, slopes_at_once> *varies; ///< whether a register has this slope, not 0 everywhere
  std::size_t vectors;
  const ProgramStep &step;
  template <class F, class Slope> void unary(const F &f, const Slope &slope) const {
    double *__restrict to = registers[step.target].data();
    const double *a = registers[step.a].data();
    Block by_a;
    for (std::size_t i = 0; i < vector_size * vectors; ++i) {
      to[i] = f(a[i]);
      by_a[i] = slope(a[i], to[i]);
    }
    each_slope([&](double da, double, std::size_t i) { return da == 0 ? 0 : by_a[i] * da; });
  }
  template <class F, class Slopes> void binary(const F &f, const Slopes &slopes_of) const {
    double *__restrict to = registers[step.target].data();
    const double *a = registers[step.a].data(), *b = registers[step.b].data();
    Block by_a, by_b;
    for (std::size_t i = 0; i < vector_size * vectors; ++i) {
      to[i] = f(a[i], b[i]);
      std::tie(by_a[i], by_b[i]) = slopes_of(a[i], b[i], to[i]);
    }
    each_slope([&](double da, double db, std::size_t i) {
      const double of_a = by_a[i] * da, of_b = by_b[i] * db;
      return (da == 0 ? 0 : of_a) + (db == 0 ? 0 : of_b);
    });
  }
  template <class F> void jump(const F &f) const {
    BlockStep{registers, vectors, step}.jump(f);
    varies[step.target] = {};
  }
  template <class First> void pick(const First &first) const {
    const double *a = registers[step.a].data(), *b = registers[step.b].data();
    select([&](std::size_t i) { return first(a[i], b[i]); });
  }
  void choose() const {
    const double *condition = registers[step.c].data();
    select([&](std::size_t i) { return condition[i] == 0; });
  }

private:
  /// to = slope(that of a, that of b, i)
  template <class Slope> void each_slope(const Slope &slope) const {
    static constexpr Block zeros{};
    const bool two = operands_of(step.operation) > 1;
    for (int k = 0; k < slopes_at_once; ++k) {
      const bool by_a = varies[step.a][k], by_b = two && varies[step.b][k];
      varies[step.target][k] = by_a || by_b;
      if (!by_a && !by_b) continue;
      double *__restrict to = slopes[step.target][k].data();
      const double *a = by_a ? slopes[step.a][k].data() : zeros.data(),
                   *b = by_b ? slopes[step.b][k].data() : zeros.data();
      for (std::size_t i = 0; i < vector_size * vectors; ++i)
        to[i] = slope(a[i], b[i], i);
    }
  }
  template <class First> void select(const First &first) const {
    double *__restrict to = registers[step.target].data();
    const double *a = registers[step.a].data(), *b = registers[step.b].data();
    Block takes_a;
    for (std::size_t i = 0; i < vector_size * vectors; ++i) {
      takes_a[i] = first(i);
      to[i] = takes_a[i] != 0 ? a[i] : b[i];
    }
    each_slope([&](double da, double db, std::size_t i) { return takes_a[i] != 0 ? da : db; });
  }
};

} // namespace rbvi
