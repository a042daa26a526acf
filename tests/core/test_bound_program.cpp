#include "rbvi/core/expression.hpp"

#include "refuses.hpp"

#include <array>
#include <cmath>

namespace rbvi::bound_program_test {
namespace {

const std::vector<std::string> parameters{"stretch", "cx"}, coordinates{"x", "y"};

Expression read(const std::string &text) {
  return parse_expression(text);
}

/// The map of a square around a disc, and results of every kind.
BoundProgram square_map(const std::vector<std::string> &by) {
  const Lets lets{{"rho", read("hypot(x, y)")},
                  {"s", read("max(0, min(1, (rho - 0.2)/0.3))")},
                  {"fade", read("(1 - s)^2*(1 + 2*s)")},
                  {"unused", read("log(-1 - rho)")},
                  {"inner", read("stretch/0.2")}};
  return bound_program(lets,
                       {read("rho > 0.2 ? stretch*x + fade*cx : cx + inner*x"), read("7"),
                        read("rho"), read("x"), read("sin(stretch)*y"), read("inner^2")},
                       parameters, coordinates, by);
}

constexpr std::size_t result_count = 6;

std::array<double, result_count> expected_map(double stretch, double cx, double x, double y) {
  const double rho = std::hypot(x, y), s = std::max(0.0, std::min(1.0, (rho - 0.2) / 0.3)),
               fade = (1 - s) * (1 - s) * (1 + 2 * s), inner = stretch / 0.2;
  return {rho > 0.2 ? stretch * x + fade * cx : cx + inner * x,
          7,
          rho,
          x,
          std::sin(stretch) * y,
          inner * inner};
}

const std::array<double, 2> mu{1.7, 0.3};

/// count x 2.
std::vector<double> points(std::size_t count) {
  std::vector<double> columns(2 * count);
  for (std::size_t i = 0; i < columns.size(); ++i)
    columns[i] = 0.6 * std::sin(1 + 3.0 * double(i));
  return columns;
}

TEST(BoundProgram, HasTheValuesOfItsResultsAtAnyNumberOfPoints) {
  const BoundProgram program = square_map({});
  for (const std::size_t count : {0, 1, 2, 3, 4, 5, 31, 32, 33, 100}) {
    const std::vector<double> at = points(count);
    std::vector<double> results(result_count * count + 1, -1);
    program.values(mu.data(), at.data(), count, results.data());
    for (std::size_t i = 0; i < count; ++i) {
      const auto expected = expected_map(mu[0], mu[1], at[i], at[count + i]);
      for (std::size_t k = 0; k < result_count; ++k)
        EXPECT_DOUBLE_EQ(results[k * count + i], expected[k]) << count << " " << i << " " << k;
    }
    EXPECT_EQ(results.back(), -1); // nothing is written behind the results
  }
}

TEST(BoundProgram, GradientsAreThoseOfDifferencesByAnyOfTheNames) {
  const std::size_t count = 3;
  const std::vector<double> at = points(count);
  for (const auto &by : std::vector<std::vector<std::string>>{
           {}, {"x", "y"}, {"cx"}, {"y", "stretch"}, {"stretch", "cx", "x", "y"}}) {
    std::vector<double> results(result_count * count), values(results),
        gradients(result_count * by.size() * count + 1, -1);
    const BoundProgram program = square_map(by);
    program.values(mu.data(), at.data(), count, values.data());
    program.values_and_gradients(mu.data(), at.data(), count, results.data(), gradients.data());
    EXPECT_EQ(results, values);
    EXPECT_EQ(gradients.back(), -1);
    for (std::size_t j = 0; j < by.size(); ++j) {
      const double step = 1e-5;
      const auto moved = [&](std::size_t i, double by_step) {
        const auto plus = [&](const char *name) { return by[j] == name ? by_step : 0; };
        return expected_map(mu[0] + plus("stretch"), mu[1] + plus("cx"), at[i] + plus("x"),
                            at[count + i] + plus("y"));
      };
      for (std::size_t i = 0; i < count; ++i)
        for (std::size_t k = 0; k < result_count; ++k)
          EXPECT_NEAR(gradients[(k * by.size() + j) * count + i],
                      (moved(i, step)[k] - moved(i, -step)[k]) / (2 * step), 1e-8)
              << by[j] << " " << i << " " << k;
    }
  }
}

TEST(BoundProgram, MoreDerivativesThanAreComputedAtOnceAreThoseOfEach) {
  std::vector<std::string> many;
  Lets lets;
  std::vector<Expression> results;
  for (int i = 0; i < 19; ++i) {
    const std::string n = std::to_string(i);
    many.push_back("p" + n);
    lets.emplace_back("q" + n, read(i == 0 ? "p0" : "q" + std::to_string(i - 1) + "*p" + n));
    results.push_back(read("q" + n));
  }
  // The first ten are parameters.
  const std::vector<std::string> first(many.begin(), many.begin() + 10),
      others(many.begin() + 10, many.end());
  const BoundProgram program = bound_program(lets, results, first, others, many);
  std::vector<double> at, values(19), gradients(19 * 19);
  for (int i = 0; i < 19; ++i)
    at.push_back(1 + 0.1 * i);
  program.values_and_gradients(at.data(), at.data() + 10, 1, values.data(), gradients.data());
  double product = 1;
  for (std::size_t k = 0; k < 19; ++k) {
    product *= at[k];
    EXPECT_NEAR(values[k], product, 1e-14 * product);
    for (std::size_t i = 0; i < 19; ++i)
      EXPECT_NEAR(gradients[19 * k + i], i <= k ? product / at[i] : 0, 1e-14 * product);
  }
}

TEST(BoundProgram, ManySharedValuesStayUntilTheirLastUse) {
  // Each of 200 values is used by a sum, and by four sums behind it in the other order.
  Lets lets;
  std::vector<Expression> results;
  std::string sum = "0";
  for (int i = 0; i < 200; ++i) {
    const std::string n = std::to_string(i);
    lets.emplace_back("f" + n, read("sin(x + " + n + ")*y"));
    sum += " + " + n + "*f" + n;
  }
  results.push_back(read(sum));
  for (int part = 0; part < 4; ++part) {
    std::string back = "0";
    for (int i = 50; i-- > 0;)
      back += " - f" + std::to_string(50 * part + i);
    results.push_back(read(back));
  }
  const BoundProgram program = bound_program(lets, results, {}, coordinates, {});
  const std::array<double, 2> at{0.3, 1.1};
  std::array<double, 5> found, expected{};
  program.values(nullptr, at.data(), 1, found.data());
  for (int i = 0; i < 200; ++i) {
    const double f = std::sin(at[0] + i) * at[1];
    expected[0] += i * f;
    expected[1 + i / 50] -= f;
  }
  for (int k = 0; k < 5; ++k)
    EXPECT_NEAR(found[k], expected[k], 1e-11);
}

TEST(BoundProgram, RefusesNamesThatAreNotKnownYetOrGivenTwice) {
  const auto made = [](const Lets &lets, const std::string &result,
                       const std::vector<std::string> &by = {}) {
    return [=] { bound_program(lets, {read(result)}, parameters, coordinates, by); };
  };
  EXPECT_TRUE(refuses("unknown name 'rhoo' in 'rhoo + 1': the nearest is 'rho'",
                      made({{"rho", read("x")}}, "rhoo + 1")));
  EXPECT_TRUE(refuses("unknown name 'b' in '2 * b'",
                      made({{"a", read("2*b")}, {"b", read("x")}}, "1"))); // also where unused
  EXPECT_TRUE(refuses("the name 'x' is given twice", made({{"x", read("1")}}, "x")));
  EXPECT_TRUE(refuses("'+a' is not a name", made({{"+a", read("1")}}, "x")));
  EXPECT_TRUE(refuses("unknown name 'rho'", made({{"rho", read("x")}}, "rho", {"rho"})));
  Lets lets;
  for (int i = 0; i < 600; ++i)
    lets.emplace_back("f" + std::to_string(i), read("x + " + std::to_string(i) + ".5"));
  std::vector<Expression> results;
  for (const auto &[name, value] : lets)
    results.push_back(read(name));
  EXPECT_TRUE(refuses("numbers at once, more than 512",
                      [&] { bound_program(lets, results, parameters, coordinates, {}); }));
}

TEST(BoundProgram, IntegerPowersAreProductsWithTheirLimits) {
  for (int n = -20; n <= 20; ++n) {
    const BoundExpression power = bound_to(read("x^(" + std::to_string(n) + ")"), {"x"});
    for (const double x : {-1.3, 0.0, -0.0, 0.7, 2.1, 1e200, 1e-200, 1.0 / 0.0}) {
      double value, slope;
      power.value_and_gradient(&x, value, &slope);
      const double expected = std::pow(x, n), expected_slope = n == 0 ? 0 : n * std::pow(x, n - 1);
      if (std::isfinite(expected) && std::abs(expected) > 1e-300) {
        EXPECT_NEAR(value, expected, 1e-14 * std::abs(expected)) << x << "^" << n;
      } else {
        EXPECT_EQ(value, expected) << x << "^" << n;
      }
      if (std::isfinite(expected_slope) && std::isfinite(expected) && x != 0) {
        EXPECT_NEAR(slope, expected_slope, 1e-13 * std::abs(expected_slope)) << x << "^" << n;
      }
    }
  }
}

} // namespace
} // namespace rbvi::bound_program_test
