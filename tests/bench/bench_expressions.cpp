// Nanoseconds per evaluation of functions as scenes have them, and their ratio to the same in C++,
// called through a std::function.
#include "rbvi/core/expression.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>

namespace {

/// A number with its derivatives by x and y.
struct Dual {
  double value, by_x = 0, by_y = 0;
  Dual(double number) : value(number) {}
  Dual(double number, double dx, double dy) : value(number), by_x(dx), by_y(dy) {}
};
Dual operator+(const Dual &a, const Dual &b) {
  return {a.value + b.value, a.by_x + b.by_x, a.by_y + b.by_y};
}
Dual operator-(const Dual &a, const Dual &b) {
  return {a.value - b.value, a.by_x - b.by_x, a.by_y - b.by_y};
}
Dual operator*(const Dual &a, const Dual &b) {
  return {a.value * b.value, a.by_x * b.value + a.value * b.by_x,
          a.by_y * b.value + a.value * b.by_y};
}
Dual operator/(const Dual &a, const Dual &b) {
  const double f = a.value / b.value;
  return {f, (a.by_x - f * b.by_x) / b.value, (a.by_y - f * b.by_y) / b.value};
}
bool operator<(const Dual &a, const Dual &b) {
  return a.value < b.value;
}
Dual hypot(const Dual &a, const Dual &b) {
  const double f = std::hypot(a.value, b.value);
  if (f == 0) return 0;
  return {f, (a.value * a.by_x + b.value * b.by_x) / f, (a.value * a.by_y + b.value * b.by_y) / f};
}

constexpr std::size_t point_count = 1000, parameter_count = 6;
// r, cx, cy, stretch, E, nu
constexpr std::array<double, parameter_count> parameters{0.18, 0.03, -0.02, 1.1, 2.1, 0.3};

struct Function {
  const char *what;
  rbvi::Lets lets;
  std::string text;
  std::function<double(const double *, double, double)> value;
  std::function<Dual(const double *, Dual, Dual)> dual;
};

template <class F> Function function(const char *what, rbvi::Lets lets, const char *text, F f) {
  return {what, std::move(lets), text,
          [f](const double *p, double x, double y) { return f(p, x, y); },
          [f](const double *p, Dual x, Dual y) { return f(p, x, y); }};
}

double seconds(const std::function<void()> &work) {
  double least = 1e9;
  for (int k = 0; k < 200; ++k) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    least = std::min(least, elapsed.count());
  }
  return least;
}

double sum_of_all = 0; // so that nothing is left out

void report(const char *what, double ours, double theirs) {
  std::printf("  %-40s %7.1f ns, C++ %6.1f ns: %5.2f\n", what, 1e9 * ours / point_count,
              1e9 * theirs / point_count, ours / theirs);
}

void measure(const Function &one) {
  std::printf("%s: %s\n", one.what, one.text.c_str());
  const std::vector<std::string> names{"r", "cx", "cy", "stretch", "E", "nu"}, place{"x", "y"};
  const auto parsed = rbvi::parse_expression(one.text);
  const auto program = rbvi::bound_program(one.lets, {parsed}, names, place, place);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(-0.5, 0.5);
  std::vector<double> columns(2 * point_count), results(3 * point_count);
  for (double &x : columns)
    x = number(random);
  const double *x = columns.data(), *y = x + point_count, *p = parameters.data();

  const double cpp = seconds([&] {
    for (std::size_t i = 0; i < point_count; ++i)
      sum_of_all += one.value(p, x[i], y[i]);
  });
  const double cpp_dual = seconds([&] {
    for (std::size_t i = 0; i < point_count; ++i)
      sum_of_all += one.dual(p, {x[i], 1, 0}, {y[i], 0, 1}).by_x;
  });
  const auto in_batches = [&](std::size_t size) {
    return seconds([&] {
      for (std::size_t first = 0; first < point_count; first += size)
        program.values(p, x + 2 * first, size, results.data() + first);
    });
  };
  report("value", in_batches(1), cpp);
  report("values at 10 points", in_batches(10), cpp);
  report("values at 1000 points", in_batches(1000), cpp);
  const auto gradients = [&](std::size_t size) {
    return seconds([&] {
      for (std::size_t first = 0; first < point_count; first += size)
        program.values_and_gradients(p, x + 2 * first, size, results.data(), &results[point_count]);
    });
  };
  report("value and gradient by x, y", gradients(1), cpp_dual);
  report("values and gradients at 10 points", gradients(10), cpp_dual);
  report("values and gradients at 1000 points", gradients(1000), cpp_dual);
  program.values(p, x, point_count, results.data());
  for (std::size_t i = 0; i < point_count; ++i)
    if (!(std::abs(results[i] - one.value(p, x[i], y[i])) < 1e-13)) std::printf("WRONG\n");
}

template <class T> T square(const T &x) {
  return x * x;
}

} // namespace

int main() {
  const auto read = [](const char *text) { return rbvi::parse_expression(text); };
  measure(function("map of the membrane",
                   {{"rho", read("hypot(x, y)")},
                    {"s", read("max(0, min(1, (rho - 0.2)/0.3))")},
                    {"fade", read("(1 - s)^2*(1 + 2*s)")}},
                   "rho > 0.2 ? stretch*x + fade*cx : cx + r/0.2*x",
                   [](const double *p, auto x, auto y) {
                     using std::hypot, std::min, std::max;
                     using T = decltype(x);
                     const T rho = hypot(x, y), s = max(T(0), min(T(1), (rho - 0.2) / 0.3)),
                             fade = square(T(1) - s) * (T(1) + T(2) * s);
                     return T(0.2) < rho ? p[3] * x + fade * p[1] : p[1] + p[0] / 0.2 * x;
                   }));
  measure(function("gap of a disk", {}, "hypot(x - cx, y - cy) - r",
                   [](const double *p, auto x, auto y) {
                     using std::hypot;
                     return hypot(x - p[1], y - p[2]) - p[0];
                   }));
  measure(function("paraboloid", {}, "-1.25*((x - cx)^2 + (y - cy)^2)/r^2",
                   [](const double *p, auto x, auto y) {
                     return -1.25 * (square(x - p[1]) + square(y - p[2])) / square(p[0]);
                   }));
  measure(function("Lame's constant", {}, "E*nu/((1 + nu)*(1 - 2*nu))",
                   [](const double *p, auto x, auto) {
                     using T = decltype(x);
                     return T(p[4] * p[5] / ((1 + p[5]) * (1 - 2 * p[5])));
                   }));
  measure(function("Lame's constant, graded", {}, "E*(1 + x^3)*nu/((1 + nu)*(1 - 2*nu))",
                   [](const double *p, auto x, auto) {
                     return p[4] * (1.0 + square(x) * x) * p[5] / ((1 + p[5]) * (1 - 2 * p[5]));
                   }));
  measure(function("waves", {}, "0.1*sin(20*x)*exp(-y^2) + 0.3*(1 + y^2)^1.5",
                   [](const double *, auto x, auto y) {
                     using T = decltype(x);
                     if constexpr (std::is_same_v<T, double>)
                       return 0.1 * std::sin(20 * x) * std::exp(-square(y)) +
                              0.3 * std::pow(1 + square(y), 1.5);
                     else {
                       const double s = std::sin(20 * x.value), c = std::cos(20 * x.value),
                                    e = std::exp(-square(y.value)), z = 1 + square(y.value),
                                    f = std::pow(z, 1.5);
                       return T(0.1 * s * e + 0.3 * f, 2 * c * e,
                                -0.2 * s * e * y.value + 0.9 * f / z * y.value);
                     }
                   }));
  return sum_of_all == 1e300;
}
