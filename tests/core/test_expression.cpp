#include "rbvi/core/expression.hpp"

#include "refuses.hpp"

#include <array>
#include <cmath>
#include <random>
#include <thread>

namespace rbvi::expression_test {
namespace {

const std::vector<std::string> names{"a", "b", "x", "y"};

double value(const std::string &text, const std::vector<double> &at = {0.7, 1.3, -0.4, 2.1}) {
  return bound_to(parse_expression(text), names).value(at.data());
}

TEST(Expression, BindsAsTheGrammarSays) {
  const double x = -0.4, y = 2.1;
  const std::vector<std::pair<std::string, double>> table{{"1", 1},
                                                          {".5", 0.5},
                                                          {"1.", 1},
                                                          {"1e-3", 1e-3},
                                                          {" 2E+2 ", 200},
                                                          {"pi", std::acos(-1)},
                                                          {"-2^2", -4},
                                                          {"2^-3", 0.125},
                                                          {"2^3^2", 512},
                                                          {"2^-2^2", 0.0625},
                                                          {"-x^2", -x * x},
                                                          {"1-2-3", -4},
                                                          {"8/4/2", 1},
                                                          {"1+2*3", 7},
                                                          {"(1+2)*3", 9},
                                                          {"2*-3", -6},
                                                          {"--3", 3},
                                                          {"+3", 3},
                                                          {"1 < 2", 1},
                                                          {"2 <= 1", 0},
                                                          {"1 + 1 == 2", 1},
                                                          {"1 != 1", 0},
                                                          {"2 > 1 and 1 > 2", 0},
                                                          {"1 or 0 and 0", 1},
                                                          {"not 1 == 2", 1},
                                                          {"not 0 and 0", 0},
                                                          {"x < 0 ? 1 : 2", 1},
                                                          {"0 ? 1 : 0 ? 2 : 3", 3},
                                                          {"1 ? 0 ? 1 : 2 : 3", 2},
                                                          {"0 or 1 ? 5 : 6", 5},
                                                          {"sqrt(y)", std::sqrt(y)},
                                                          {"cbrt(x)", std::cbrt(x)},
                                                          {"exp(x)", std::exp(x)},
                                                          {"log(y)", std::log(y)},
                                                          {"log10(y)", std::log10(y)},
                                                          {"log2(8)", 3},
                                                          {"sin(x)", std::sin(x)},
                                                          {"cos(x)", std::cos(x)},
                                                          {"tan(x)", std::tan(x)},
                                                          {"asin(x)", std::asin(x)},
                                                          {"acos(x)", std::acos(x)},
                                                          {"atan(x)", std::atan(x)},
                                                          {"sinh(x)", std::sinh(x)},
                                                          {"cosh(x)", std::cosh(x)},
                                                          {"tanh(x)", std::tanh(x)},
                                                          {"abs(x)", -x},
                                                          {"sign(x)", -1},
                                                          {"floor(x)", -1},
                                                          {"ceil(y)", 3},
                                                          {"atan2(x, y)", std::atan2(x, y)},
                                                          {"pow(y, 3)", std::pow(y, 3)},
                                                          {"min(3, 1, 2)", 1},
                                                          {"max(3, 1, 4, 2)", 4},
                                                          {"hypot(2, 3, 6)", 7}};
  for (const auto &[text, expected] : table) {
    EXPECT_DOUBLE_EQ(value(text), expected) << text;
    const Expression parsed = parse_expression(text);
    EXPECT_EQ(parse_expression(parsed.text()).program(), parsed.program()) << parsed.text();
  }
  EXPECT_TRUE(std::isnan(value("min(log(-1), 1)")) && std::isnan(value("max(1, log(-1))")));
  EXPECT_EQ(value("1/0"), INFINITY);
}

TEST(Expression, HypotNeitherOverflowsNorLosesDigits) {
  const BoundExpression bound = bound_to(parse_expression("hypot(x, y)"), {"x", "y"});
  for (const double scale : {1e-320, 1e-300, 1e-160, 1e-140, 1e-139, 1.0, 1e139, 1e140, 1e300})
    for (const double ratio : {0.0, 1e-20, 0.3, 1.0}) {
      const std::array<double, 2> at{scale, -ratio * scale};
      EXPECT_DOUBLE_EQ(bound.value(at.data()), std::hypot(at[0], at[1])) << scale << " " << ratio;
    }
  EXPECT_EQ(value("hypot(1/0, log(-1))"), INFINITY);
}

TEST(Expression, HasItsFreeNamesSortedAndAConstant) {
  EXPECT_EQ(parse_expression("y + b * pi + y").free_names(), (std::vector<std::string>{"b", "y"}));
  EXPECT_EQ(parse_expression("2 * 3").constant(), 6);
  EXPECT_FALSE(parse_expression("2 * a").constant());
}

TEST(Expression, RefusesInOneLineWithTheColumn) {
  const std::string deep(70, '(');
  const std::vector<std::pair<std::string, std::string>> table{
      {"", "an expression is empty"},
      {"  ", "an expression is empty"},
      {"a ** 2", "column 3 of 'a ** 2': write ^ for **"},
      {"a = 2", "column 3 of 'a = 2': write =="},
      {"a && b", "write and for &&"},
      {"!a", "column 1 of '!a': write not for !"},
      {"a, b", "column 2 of 'a, b': a comma"},
      {"(a, b)", "column 3 of '(a, b)': a comma"},
      {"min(a,,b)", "column 7 of 'min(a,,b)': a number, a name or '(' is missing before ','"},
      {"1 + sine(a)", "column 5 of '1 + sine(a)': unknown function 'sine': the nearest is 'sin"},
      {"sqr(a)", "the nearest is 'sqrt'"},
      {"1 + (a", "column 5 of '1 + (a': '(' is not closed"},
      {"sin(a", "column 4 of 'sin(a': '(' is not closed"},
      {"a)", "column 2 of 'a)': ')' closes nothing"},
      {"a 2", "column 3 of 'a 2': an operator is missing before '2'"},
      {"2a", "column 2 of '2a': an operator is missing before 'a'"},
      {"a +", "column 4 of 'a +': a number, a name or '(' is missing"},
      {"a\n+", "of 'a +'"},
      {"sin", "sin is a function: write sin(...)"},
      {"sin(a, b)", "sin takes 1 argument, not 2"},
      {"atan2(a)", "atan2 takes 2 arguments, not 1"},
      {"min(a)", "min takes 2 arguments or more, not 1"},
      {"a < b < x", "column 7"},
      {"a ? b", "column 6 of 'a ? b': ':' is missing"},
      {"a $ b", "column 3 of 'a $ b': '$' cannot stand here"},
      {"1e999", "outside the range"},
      {"a + not b", "column 5"},
      {deep, "nested deeper than 64"}};
  for (const auto &[text, words] : table)
    EXPECT_TRUE(refuses(words, [&] { parse_expression(text); })) << text;
  EXPECT_TRUE(refuses("unknown name 'yy' in 'yy + 1': the nearest is 'y'",
                      [] { bound_to(parse_expression("yy+1"), names); }));
}

TEST(Expression, DerivativesAreThoseOfDifferences) {
  for (const char *text :
       {"a*b/x - y", "a^b", "x^3", "2^x", "sqrt(a)*cbrt(b)", "exp(x)/log(y)", "log10(a) + log2(b)",
        "sin(x)*cos(y)*tan(a)", "asin(x) + acos(x/2)*atan(y)", "sinh(x)*cosh(y)*tanh(a)",
        "abs(x)*y", "atan2(x, y)", "min(a, x)*max(b, y)", "hypot(a, b, x)", "x < 0 ? a^2 : b",
        "floor(y) + sign(x)*y", "-(x - y)^2", "x > 0 ? log(x) : a*x"}) {
    const BoundExpression bound = bound_to(parse_expression(text), names);
    std::array<double, 4> at{0.7, 1.3, -0.4, 2.1}, gradient;
    double exact = 0;
    bound.value_and_gradient(at.data(), exact, gradient.data());
    EXPECT_EQ(exact, bound.value(at.data()));
    for (std::size_t i = 0; i < 4; ++i) {
      const double step = 1e-5, middle = at[i];
      at[i] = middle + step;
      const double above = bound.value(at.data());
      at[i] = middle - step;
      const double below = bound.value(at.data());
      at[i] = middle;
      EXPECT_NEAR(gradient[i], (above - below) / (2 * step), 1e-8) << text << " " << names[i];
    }
  }
}

TEST(Expression, DerivativesAtKinksAreOfOneSideAndOfTheNamesWanted) {
  const auto slope = [](const char *text) {
    const BoundExpression bound = bound_to(parse_expression(text), names, {"x"});
    const std::array<double, 4> at{};
    double unused, result;
    bound.value_and_gradient(at.data(), unused, &result);
    return result;
  };
  EXPECT_EQ(slope("abs(x)"), 1);
  EXPECT_EQ(slope("min(2*x, 3*x)"), 2);
  EXPECT_EQ(slope("max(3*x, 2*x)"), 3);
  EXPECT_EQ(slope("hypot(x, y)"), 0);
  EXPECT_EQ(slope("sqrt(y) + x"), 1); // the slope of sqrt is infinite, y does not vary
  EXPECT_EQ(slope("sqrt(x)"), INFINITY);
  EXPECT_EQ(slope("max(1, sqrt(x)) + sign(1 + sqrt(x))"), 0); // nor does what is not taken
}

TEST(Expression, ManyNamesPointsAndThreadsGiveTheSame) {
  std::vector<std::string> many;
  std::string sum = "0";
  for (int i = 0; i < 19; ++i) {
    many.push_back("p" + std::to_string(i));
    sum += " + " + std::to_string(i) + " * " + many.back() + "^2";
  }
  const BoundExpression bound = bound_to(parse_expression(sum), many);
  const std::size_t count = 75;
  std::vector<double> columns(19 * count);
  for (std::size_t i = 0; i < columns.size(); ++i)
    columns[i] = std::sin(double(i));
  const auto all = [&] {
    std::vector<double> results(count * 20);
    bound.values(columns.data(), count, results.data());
    for (std::size_t k = 0; k < count; ++k) {
      std::array<double, 19> at;
      for (std::size_t i = 0; i < 19; ++i)
        at[i] = columns[i * count + k];
      double here = 0;
      double *gradient = results.data() + count + 19 * k;
      bound.value_and_gradient(at.data(), here, gradient);
      EXPECT_DOUBLE_EQ(here, results[k]);
      for (std::size_t i = 0; i < 19; ++i)
        EXPECT_DOUBLE_EQ(gradient[i], 2 * double(i) * at[i]);
    }
    return results;
  };
  const std::vector<double> expected = all();
  std::vector<std::vector<double>> results(4);
  std::vector<std::thread> threads;
  for (auto &one : results)
    threads.emplace_back([&] { one = all(); });
  for (std::thread &one : threads)
    one.join();
  for (const auto &one : results)
    EXPECT_EQ(one, expected);
}

TEST(Expression, SeparatesByStructure) {
  const std::vector<std::pair<std::string, std::size_t>> table{{"a + x", 2},
                                                               {"x + a + 3 + y", 2},
                                                               {"3", 1},
                                                               {"sin(a + b)*exp(x*y)", 1},
                                                               {"a*x + b*x", 1},
                                                               {"(a + x)*(b - y)", 4},
                                                               {"(1 + a*x)^2", 3},
                                                               {"-(a*x - y)/(b*y)", 2},
                                                               {"(a*x)^-2", 1},
                                                               {"(a - x)^4", 5},
                                                               {"x < 0.5 ? a*x : b + y", 3},
                                                               {"a > 1 ? x : y", 2},
                                                               {"a*x - (b + 2)*y", 2}};
  std::mt19937 random(2);
  std::uniform_real_distribution<double> number(0.3, 2);
  for (const auto &[text, most] : table) {
    const Expression whole = parse_expression(text);
    const auto sum = separated(whole, {"a", "b"});
    ASSERT_TRUE(sum) << text;
    EXPECT_LE(sum->size(), most) << text;
    for (int k = 0; k < 20; ++k) {
      std::array<double, 4> at;
      for (double &one : at)
        one = number(random);
      double total = 0;
      for (const auto &[f, g] : *sum)
        total +=
            bound_to(f, {"a", "b"}).value(at.data()) * bound_to(g, {"x", "y"}).value(at.data() + 2);
      EXPECT_NEAR(total, bound_to(whole, names).value(at.data()), 1e-11) << text;
    }
  }
  for (const char *text :
       {"sin(a + x)", "1/(a + x)", "a^x", "(a + x)^0.5", "(a*x)^0.5", "(a + x)^5", "a < x",
        "min(a, x)", "a < x ? 1 : 2", "(a + x)*(a^2 + sin(x)) + abs(a*x)"})
    EXPECT_FALSE(separated(parse_expression(text), {"a", "b"})) << text;
}

} // namespace
} // namespace rbvi::expression_test
