#include "random_expression.hpp"
#include "refuses.hpp"

#include <muParser.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rbvi::expression_random_test {
namespace {

const std::vector<std::string> all_names{"a", "b", "x", "y"};

std::vector<double> of_its_names(const Expression &expression, const std::array<double, 4> &at) {
  std::vector<double> values;
  for (const std::string &name : expression.free_names())
    for (std::size_t i = 0; i < 4; ++i)
      if (all_names[i] == name) values.push_back(at[i]);
  return values;
}

/// muParser, with the functions that it lacks.
struct Referee {
  std::array<double, 4> at{};
  mu::Parser parser;
  Referee() {
    for (std::size_t i = 0; i < 4; ++i)
      parser.DefineVar(all_names[i], &at[i]);
    const auto one = [&](const char *name, double (*f)(double)) { parser.DefineFun(name, f); };
    one("cbrt", [](double x) { return std::cbrt(x); });
    one("floor", [](double x) { return std::floor(x); });
    one("ceil", [](double x) { return std::ceil(x); });
    parser.DefineFun(
        "hypot", +[](double x, double y) { return std::hypot(x, y); });
  }
};

TEST(ExpressionRandom, HasTheValueOfMuParser) {
  RandomExpressions expressions(1, all_names);
  std::uniform_real_distribution<double> number(-2, 2);
  const std::vector<double> special{0, 1, -1, 2, 1e3};
  Referee referee;
  int undecided = 0, finite = 0;
  const int count = 100000;
  for (int k = 0; k < count; ++k) {
    const RandomText text = expressions.number(1 + k % 4);
    for (double &one : referee.at)
      one = expressions.pick(8) == 0 ? expressions.one_of(special) : number(expressions.random);
    referee.parser.SetExpr(text.theirs);
    const double theirs = referee.parser.Eval();
    const Expression parsed = parse_expression(text.ours);
    const double ours = bound_to(parsed, all_names).value(referee.at.data());
    const BoundedValue bound = bounded(parsed, of_its_names(parsed, referee.at));
    if (bound.error > std::numeric_limits<double>::max()) {
      ++undecided;
      continue;
    }
    if (!std::isfinite(ours) && !std::isfinite(theirs)) continue;
    ++finite;
    ASSERT_LE(std::abs(ours - theirs), 4 * bound.error)
        << text.ours << " = " << ours << ", " << text.theirs << " = " << theirs;
    ASSERT_EQ(parse_expression(parsed.text()).program(), parsed.program()) << text.ours;
  }
  EXPECT_LT(undecided, count / 20);
  EXPECT_GT(finite, count / 2);
}

/// By Ridders' extrapolation of central differences; its error is at least their noise.
struct Slope {
  double value, error;
};

Slope difference(const BoundExpression &bound, std::array<double, 4> at, std::size_t name) {
  constexpr std::size_t levels = 8;
  std::array<std::array<double, levels>, levels> table{};
  Slope best{0, std::numeric_limits<double>::infinity()};
  const double middle = at[name];
  double step = 0.04;
  for (std::size_t i = 0; i < levels; ++i, step /= 1.7) {
    at[name] = middle + step;
    const double above = bound.value(at.data());
    at[name] = middle - step;
    table[i][0] = (above - bound.value(at.data())) / (2 * step);
    double factor = 1;
    for (std::size_t j = 1; j <= i; ++j) {
      factor *= 1.7 * 1.7;
      table[i][j] = (table[i][j - 1] * factor - table[i - 1][j - 1]) / (factor - 1);
      // Values of 1e12 have differences that agree because they are multiples of 1e-4.
      const double noise = std::numeric_limits<double>::epsilon() * std::abs(above) / step;
      const double error = std::max({noise, std::abs(table[i][j] - table[i][j - 1]),
                                     std::abs(table[i][j] - table[i - 1][j - 1])});
      if (error < best.error) best = {table[i][j], error};
    }
  }
  return best;
}

constexpr std::size_t block = 7;

/// At (x, y) and six points near it, evaluated together; a and b are parameters.
struct InBlock {
  std::array<double, 2 * block> columns;
  std::array<double, block> values, values_alone;
  std::array<double, 4 * block> gradients;
  InBlock(const Expression &expression, const std::array<double, 4> &at) {
    const BoundProgram program = bound_program({}, {expression}, {"a", "b"}, {"x", "y"}, all_names);
    for (std::size_t i = 0; i < block; ++i) {
      columns[i] = at[2] + 0.1 * double(i);
      columns[block + i] = at[3] - 0.1 * double(i);
    }
    program.values(at.data(), columns.data(), block, values_alone.data());
    program.values_and_gradients(at.data(), columns.data(), block, values.data(), gradients.data());
  }
};

TEST(ExpressionRandom, DerivativesAreThoseOfDifferences) {
  RandomExpressions expressions(2, all_names);
  std::uniform_real_distribution<double> number(0.2, 1.8);
  int checked = 0, nonzero = 0;
  const int count = 20000;
  for (int k = 0; k < count; ++k) {
    const RandomText text = expressions.number(1 + k % 4);
    const Expression parsed = parse_expression(text.ours);
    const BoundExpression bound = bound_to(parsed, all_names);
    std::array<double, 4> at, gradient;
    for (double &one : at)
      one = number(expressions.random);
    double value;
    bound.value_and_gradient(at.data(), value, gradient.data());
    if (!bounded(parsed, of_its_names(parsed, at)).all_finite) continue;
    ASSERT_EQ(value, bound.value(at.data())) << text.ours;
    const InBlock together(parsed, at);
    for (std::size_t i = 0; i < block; ++i) {
      const std::array<double, 4> here{at[0], at[1], together.columns[i],
                                       together.columns[block + i]};
      const BoundedValue expected = bounded(parsed, of_its_names(parsed, here));
      if (!std::isfinite(expected.value) || !std::isfinite(expected.error)) continue;
      ASSERT_NEAR(together.values[i], expected.value, 4 * expected.error) << text.ours;
      ASSERT_NEAR(together.values_alone[i], expected.value, 4 * expected.error) << text.ours;
    }
    for (std::size_t i = 0; i < 4; ++i) {
      const Slope slope = difference(bound, at, i);
      const double scale = 1 + std::abs(slope.value);
      if (!(slope.error < 1e-10 * scale)) continue; // a kink, a jump or a pole is near
      ++checked;
      nonzero += slope.value != 0;
      ASSERT_NEAR(gradient[i], slope.value, 1e-8 * scale) << text.ours << " by " << all_names[i];
      ASSERT_NEAR(together.gradients[i * block], slope.value, 1e-8 * scale)
          << text.ours << " by " << all_names[i];
    }
  }
  EXPECT_GT(checked, 4 * count * 7 / 10);
  EXPECT_GT(nonzero, count);
}

/// Of the structure that separates: operands have names of one group.
RandomText separable(RandomExpressions &first, RandomExpressions &second, int depth) {
  const auto of_one = [&](int size) {
    return first.pick(2) == 0 ? first.number(size) : second.number(size);
  };
  if (depth == 0) return of_one(2);
  const auto part = [&] { return separable(first, second, depth - 1); };
  switch (first.pick(6)) {
  case 0:
    return first.joined(part(), "+", part());
  case 1:
    return first.joined(part(), "-", part());
  case 2:
    return first.joined(part(), "*", part());
  case 3:
    return first.joined(part(), "/", first.joined(first.number(1), "*", second.number(1)));
  case 4: {
    const std::string n = std::to_string(1 + first.pick(3));
    return first.joined(part(), "^", {n, n, 9});
  }
  default:
    return first.chosen(first.pick(2) == 0 ? first.truth(1) : second.truth(1), part(), part());
  }
}

TEST(ExpressionRandom, SeparatedSumsAreTheExpression) {
  RandomExpressions first(3, {"a", "b"}), second(4, {"x", "y"});
  std::uniform_real_distribution<double> number(0.2, 1.8);
  int split = 0, compared = 0, terms = 0;
  const int count = 10000;
  for (int k = 0; k < count; ++k) {
    const RandomText text = separable(first, second, 1 + k % 3);
    const Expression whole = parse_expression(text.ours);
    const auto sum = separated(whole, {"a", "b"});
    if (!sum) continue;
    ++split;
    terms += static_cast<int>(sum->size());
    std::array<double, 4> at;
    for (double &one : at)
      one = number(first.random);
    double total = 0, error = 0;
    for (const auto &[f, g] : *sum) {
      const BoundedValue of_f = bounded(f, of_its_names(f, at)),
                         of_g = bounded(g, of_its_names(g, at));
      const std::vector<std::string> groups[] = {{"a", "b"}, {"x", "y"}};
      const double product =
          bound_to(f, groups[0]).value(at.data()) * bound_to(g, groups[1]).value(at.data() + 2);
      total += product;
      error += 1e-15 * std::abs(product) + std::abs(of_f.value) * of_g.error +
               std::abs(of_g.value) * of_f.error;
    }
    const BoundedValue bound = bounded(whole, of_its_names(whole, at));
    error += bound.error;
    // A factor that is not finite makes the sum so; the whole may have left it out.
    if (!std::isfinite(error) || !std::isfinite(total)) continue;
    ++compared;
    ASSERT_NEAR(total, bound_to(whole, all_names).value(at.data()), 4 * error) << text.ours;
  }
  EXPECT_GT(split, count * 8 / 10);
  EXPECT_GT(compared, split / 2);
  EXPECT_GT(terms, 2 * split);
}

} // namespace
} // namespace rbvi::expression_random_test
