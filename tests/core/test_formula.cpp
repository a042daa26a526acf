// Functions written as expressions: their values, what they depend on.
#include "rbvi/core/error.hpp"
#include "rbvi/core/formula.hpp"
#include "tests/linear_algebra.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::formula_test {
namespace {

Expression parsed(const std::string &text) {
  return parse_expression(text);
}

const std::vector<std::string> parameters{"a", "b", "c"};
const std::vector<Let> lets{{"r", parsed("hypot(x, y)")},
                            {"twice", parsed("2*c")},
                            {"scale", parsed("r*twice")},
                            {"idle", parsed("b + nowhere")}};

Formula formula(const std::vector<std::string> &values) {
  Formula result{{}, lets, parameters};
  for (const std::string &value : values)
    result.values.push_back(parsed(value));
  return result;
}

const FullMu mu{2, 3, 5};

TEST(Formula, HasTheValuesOfItsExpressions) {
  const Point x{3, 4, 7}, n{0.6, 0.8, 0};
  const auto c = coefficient_of(formula({"a^b + twice"}));
  EXPECT_EQ(c(mu), 18);
  const auto v = point_value_of(formula({"scale + z"}));
  EXPECT_EQ(v(mu, x), 57);
  const auto m = point_map_of(formula({"scale*x", "a - y"}));
  EXPECT_EQ(m(mu, x), (Point{150, -2, 0}));
  for (const char *second : {"3 - b", "b^2 + twice"}) { // the same everywhere: affine, and not
    const auto same = point_map_of(formula({"2*a", second}));
    EXPECT_EQ(same(mu, x), (Point{4, std::string(second) == "3 - b" ? 0.0 : 19.0, 0})) << second;
  }
  const auto t = traction_of(formula({"a*nx", "y*ny", "z"}));
  EXPECT_EQ(t(mu, x, n), (Point{1.2, 3.2, 7}));
}

/// What bends or jumps where nobody looks is not taken for a straight line.
TEST(Formula, KinksAndJumpsAreNotAffine) {
  for (const char *text : {"min(a, 5000)", "max(a, 2000)", "a == 2500 ? 1 : 30",
                           "a > 2000 and a < 3000 ? 1 : 30", "abs(a + 5000)", "floor(a/1e6)"}) {
    const auto value = coefficient_of(formula({text}));
    for (const double a : {-8000.0, 0.0, 2500.0, 8000.0, 2e6})
      EXPECT_EQ(value({a, 3, 5}), bound_to(parsed(text), {"a"}).value(&a)) << text << a;
  }
}

TEST(Formula, DependsOnWhatItsLetsUse) {
  EXPECT_EQ(dependence_of(formula({"scale"})), (std::vector<int>{2}));
  EXPECT_EQ(dependence_of(formula({"b", "r + a"})), (std::vector<int>{0, 1}));
  EXPECT_TRUE(dependence_of(formula({"r"})).empty());
  EXPECT_TRUE(depends_on_point(formula({"scale"})));
  EXPECT_FALSE(depends_on_point(formula({"twice + a"})));
  EXPECT_TRUE(depends_on_point(formula({"nx"})));
}

TEST(Formula, ExpandedIsWrittenOut) {
  const Expression whole = expanded(parsed("scale + a"), lets);
  EXPECT_EQ(whole.free_names(), (std::vector<std::string>{"a", "c", "x", "y"}));
  const double values[] = {2, 5, 3, 4};
  EXPECT_EQ(bound_to(whole, {"a", "c", "x", "y"}).value(values), 52);
}

TEST(Formula, NamesThatAreNotThereAreRefused) {
  EXPECT_TRUE(refuses("unknown name 'd'", [] { (void)coefficient_of(formula({"a + d"})); }));
  EXPECT_TRUE(refuses("unknown name 'x'", [] { (void)coefficient_of(formula({"a + x"})); }));
  EXPECT_TRUE(refuses("unknown name 'nx'", [] { (void)point_value_of(formula({"nx"})); }));
  EXPECT_TRUE(refuses("unknown name 'nowhere'", [] { (void)coefficient_of(formula({"idle"})); }));
}

TEST(Formula, AConditionThatFailsSaysItsMessageWithValues) {
  const auto check =
      check_of(formula({"a < b", "c <= 5"}), {"a is {a}, above {b}", "c {twice/2} !"});
  EXPECT_NO_THROW(check(mu));
  EXPECT_TRUE(refuses("a is 4, above 3", [&] { check({4, 3, 5}); }));
  EXPECT_TRUE(refuses("c 6 !", [&] { check({2, 3, 6}); }));
  EXPECT_TRUE(refuses("c nan !", [&] { check({2, 3, std::nan("")}); }));
}

} // namespace
} // namespace rbvi::formula_test
