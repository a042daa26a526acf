// Texts that nobody means: they are refused in one line, or read.
#include "random_expression.hpp"
#include "refuses.hpp"

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <functional>

namespace rbvi::expression_fuzz_test {
namespace {

/// The column of a refusal is in the text, its line short and of letters that can be printed.
testing::AssertionResult is_kind(const std::string &message, const std::string &text) {
  for (const unsigned char c : message)
    if (c < ' ' || c == 127) return testing::AssertionFailure() << "control character " << int(c);
  if (message.size() > 300) return testing::AssertionFailure() << "too long: " << message;
  if (message.starts_with("an expression is empty")) return testing::AssertionSuccess();
  if (!message.starts_with("column ")) return testing::AssertionFailure() << message;
  const std::size_t column = std::stoul(message.substr(7));
  if (column < 1 || column > text.size() + 1)
    return testing::AssertionFailure() << "no such column: " << message;
  return testing::AssertionSuccess();
}

/// Reads a text, and does with the expression all that can be done. How many were read.
int tried(const std::string &text, bool also_separate = true) {
  const std::string shown = text.substr(0, 200);
  try {
    const Expression parsed = parse_expression(text);
    EXPECT_EQ(parse_expression(parsed.text()).program(), parsed.program()) << shown;
    const std::vector<std::string> &names = parsed.free_names();
    std::vector<double> at(names.size(), 0.7), gradient(names.size());
    const BoundExpression bound = bound_to(parsed, names);
    double value;
    bound.value_and_gradient(at.data(), value, gradient.data());
    const double alone = bound.value(at.data());
    EXPECT_TRUE(value == alone || (std::isnan(value) && std::isnan(alone))) << shown;
    if (also_separate && !names.empty()) separated(parsed, {names[0]});
    return 1;
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::bad_input) << shown;
    EXPECT_TRUE(is_kind(error.what(), text)) << shown;
    return 0;
  }
}

const std::vector<std::string> tokens{"1",
                                      "0",
                                      ".5",
                                      "1e3",
                                      "x",
                                      "y",
                                      "long_name_1",
                                      "pi",
                                      "sin(",
                                      "min(",
                                      "hypot(",
                                      "pow",
                                      "sqrt",
                                      "(",
                                      ")",
                                      ",",
                                      "+",
                                      "-",
                                      "*",
                                      "/",
                                      "^",
                                      "<",
                                      "<=",
                                      "==",
                                      "!=",
                                      "?",
                                      ":",
                                      " and ",
                                      " or ",
                                      " not ",
                                      " ",
                                      "**",
                                      "&&",
                                      "=",
                                      "!",
                                      ".",
                                      "e",
                                      "\n",
                                      std::string(1, 0),
                                      "\xC3\xA4",
                                      "\xE2\x88\x92",
                                      "\xFF",
                                      "1e999"};

/// A valid text with some damage.
std::string damaged(RandomExpressions &expressions) {
  std::string text = expressions.number(1 + expressions.pick(4)).ours;
  for (int k = expressions.pick(4); k >= 0; --k) {
    const std::size_t at = static_cast<std::size_t>(expressions.pick(int(text.size()) + 1)),
                      size = static_cast<std::size_t>(expressions.pick(6));
    const std::string part = text.substr(at, size);
    switch (expressions.pick(4)) {
    case 0:
      text.erase(at, size);
      break;
    case 1:
      text.insert(at, expressions.one_of(tokens));
      break;
    case 2:
      text.insert(static_cast<std::size_t>(expressions.pick(int(text.size()) + 1)), part);
      break;
    default:
      if (at < text.size()) text[at] = static_cast<char>(expressions.pick(256));
    }
  }
  return text;
}

std::string some_tokens(RandomExpressions &expressions) {
  std::string text;
  for (int k = expressions.pick(12); k >= 0; --k)
    text += expressions.one_of(tokens);
  return text;
}

std::string some_bytes(RandomExpressions &expressions) {
  std::string text(static_cast<std::size_t>(expressions.pick(20)), '\0');
  for (char &c : text)
    c = static_cast<char>(expressions.pick(256));
  return text;
}

// RBVI_FUZZ_SECONDS=3600 goes on for an hour.
TEST(ExpressionFuzz, AnyTextIsReadOrRefusedInOneLine) {
  const char *asked = std::getenv("RBVI_FUZZ_SECONDS");
  const double seconds = asked ? std::atof(asked) : 0;
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  for (unsigned seed = 1; seed == 1 || elapsed() < seconds; ++seed) {
    RandomExpressions expressions(seed, {"a", "b", "x", "long_name_1"});
    int from_damaged = 0, from_tokens = 0;
    for (int k = 0; k < 50000 && !testing::Test::HasFailure(); ++k) {
      from_damaged += tried(damaged(expressions));
      from_tokens += tried(some_tokens(expressions));
      tried(some_bytes(expressions));
    }
    ASSERT_FALSE(testing::Test::HasFailure()) << "seed " << seed;
    EXPECT_GT(from_damaged, 5000);
    EXPECT_GT(from_tokens, 500);
  }
}

std::string repeated(const std::string &text, std::size_t count) {
  std::string all;
  all.reserve(text.size() * count);
  while (count-- > 0)
    all += text;
  return all;
}

/// What can be repeated in front of an operand, and what then closes it.
const std::vector<std::pair<std::string, std::string>> nests{
    {"(", ")"},         {"-", ""},           {"+", ""},
    {"not ", ""},       {"sin(", ")"},       {"2^", ""},
    {"2^-", ""},        {"(2)^", ""},        {"1+(", ")"},
    {"1-2*(3^(", "))"}, {"x?1:", ""},        {"x?", ":1"},
    {"(x?1:", ")"},     {"(1<", ")"},        {"min(1,", ")"},
    {"min(", ",1)"},    {"min(", ",1,2)"},   {"pow(2,1+", ")"},
    {"pow(1+", ",2)"},  {"atan2(1<", ",2)"}, {"hypot(1,2,", ",x)"},
    {"1 or (", ")"},    {"(not ", ")"},      {"-(", ")"},
    {"((", "))"}};

TEST(ExpressionFuzz, AnyDepthIsReadOrRefused) {
  for (const auto &[open, close] : nests) {
    int deepest = 0;
    for (std::size_t depth = 1; depth <= 130; ++depth)
      if (tried(repeated(open, depth) + "x" + repeated(close, depth)) == 1)
        deepest = static_cast<int>(depth);
    EXPECT_GE(deepest, 20) << open;
    EXPECT_LT(deepest, 130) << open;
    tried(repeated(open, 200000) + "x" + repeated(close, 200000));
    tried(repeated(open, 200000)); // never closed
  }
}

TEST(ExpressionFuzz, LongTextsTakeLinearTime) {
  const auto seconds = [](const std::string &text) {
    double least = 1e9;
    for (int k = 0; k < 3; ++k) {
      const std::clock_t start = std::clock();
      tried(text, false);
      least = std::min(least, double(std::clock() - start) / CLOCKS_PER_SEC);
    }
    return least;
  };
  const auto names = [](std::size_t count) {
    std::string text = "x0";
    for (std::size_t i = 1; i < count; ++i)
      text += "+x" + std::to_string(i % 200);
    return text;
  };
  const auto many_names = [](std::size_t count) {
    std::string text = "x0";
    for (std::size_t i = 1; i < count; ++i)
      text += "+x" + std::to_string(i);
    return text + " $"; // is read and then refused
  };
  const auto chain = [](const std::string &first, const std::string &more,
                        const std::string &last) {
    return [=](std::size_t count) { return first + repeated(more, count) + last; };
  };
  const std::vector<std::function<std::string(std::size_t)>> texts{
      names,
      many_names,
      chain("x", "+1", ""),
      chain("x", "*2-y/3", ""),
      chain("min(x", ",y", ")"),
      chain("x<1", " and y>2 or x<y", ""),
      chain("", "y", ""),
      chain("", "y", "(x)"),
      chain("0.", "1", ""),
      chain("1", "0", ""),
      chain("", " ", "x"),
      chain("x ", "\xC3\xA4", ""),
      chain("", "(x)*(y)+", ""),
      chain("$", "$", "")};
  for (std::size_t k = 0; k < texts.size(); ++k) {
    const double few = seconds(texts[k](5000)), many = seconds(texts[k](40000));
    EXPECT_LT(many, 24 * few + 0.01) << "text " << k; // 8 if linear, 64 if quadratic
  }
}

} // namespace
} // namespace rbvi::expression_fuzz_test
