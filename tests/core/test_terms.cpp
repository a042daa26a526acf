// Sums of terms: which of them count as one where parameters are fixed, and what a coefficient that
// is not a number says.
#include "rbvi/core/terms.hpp"

#include "refuses.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::terms_test {
namespace {

enum Position { kappa, nu };

/// lambda A_0 + shear A_1 + kappa lambda A_2 + kappa shear A_3.
Sum four_terms() {
  const Factor lambda{"lambda", [](const FullMu &mu) { return 1 / (1 - 2 * mu[nu]); }, {nu}};
  const Factor shear{"shear", [](const FullMu &mu) { return 1 / (1 + mu[nu]); }, {nu}};
  const Factor scale{"kappa", [](const FullMu &mu) { return mu[kappa]; }, {kappa}};
  return {exact_term({}, {lambda}), exact_term({}, {shear}), exact_term({}, {scale, lambda}),
          exact_term({}, {shear, scale})};
}

ParameterSpace space(std::vector<int> free) {
  return {{{"kappa", "", 0.2, 5, 3}, {"nu", "", 0.2, 0.45, 0.25}}, std::move(free)};
}

/// Numbers of the terms of each group.
std::vector<std::vector<int>> groups(const SplitSum &split) {
  std::vector<std::vector<int>> result;
  for (const ExactGroup &group : split.exact) {
    result.emplace_back();
    for (const auto &member : group.members)
      result.back().push_back(member.term);
  }
  return result;
}

using Groups = std::vector<std::vector<int>>;

TEST(SplitSum, TermsOfProportionalCoefficientsCountAsOne) {
  const Sum sum = four_terms();
  EXPECT_EQ(groups(split_sum(sum, space({kappa, nu}))), (Groups{{0}, {1}, {2}, {3}}));
  EXPECT_EQ(groups(split_sum(sum, space({kappa}))), (Groups{{0, 1}, {2, 3}}));
  EXPECT_EQ(groups(split_sum(sum, space({nu}))), (Groups{{0, 2}, {1, 3}}));
  EXPECT_EQ(groups(split_sum(sum, space({}))), (Groups{{0, 1, 2, 3}}));
}

TEST(SplitSum, TheConstantGroupIsFirst) {
  Sum sum = four_terms();
  std::swap(sum[0], sum[3]);
  const SplitSum split = split_sum(sum, space({kappa}));
  EXPECT_EQ(groups(split), (Groups{{1, 3}, {0, 2}}));
  EXPECT_TRUE(split.exact.front().factors.empty());
}

TEST(CommonCoefficient, IsTheProductOfTheFactorsOfEveryTerm) {
  Sum sum = four_terms();
  const FullMu mu{3, 0.3};
  EXPECT_EQ(common_coefficient(sum, space({kappa, nu}), mu), 1);
  EXPECT_EQ(parameters_beside_common(sum, space({kappa, nu})), (std::vector<int>{kappa, nu}));
  sum.erase(sum.begin(), sum.begin() + 2);
  EXPECT_EQ(common_coefficient(sum, space({kappa, nu}), mu), 3);
  EXPECT_EQ(common_coefficient(sum, space({nu}), mu), 1) << "kappa is fixed";
  EXPECT_EQ(parameters_beside_common(sum, space({kappa, nu})), std::vector<int>{nu});
  (*sum[0].theta).push_back((*sum[0].theta)[0]);
  EXPECT_EQ(common_coefficient(sum, space({kappa, nu}), mu), 3) << "twice in one term alone";
  EXPECT_EQ(parameters_beside_common(sum, space({kappa, nu})), (std::vector<int>{kappa, nu}));
  sum.push_back(mapped_term({}, std::vector<int>{nu}));
  EXPECT_EQ(common_coefficient(sum, space({kappa, nu}), mu), 1);
}

TEST(SplitSum, TheOrderOfFactorsDoesNotMatter) {
  Sum sum = four_terms();
  std::swap((*sum[2].theta)[0], (*sum[2].theta)[1]);
  sum.push_back(sum[2]);
  EXPECT_EQ(groups(split_sum(sum, space({kappa, nu}))), (Groups{{0}, {1}, {2, 4}, {3}}));
}

/// Weight times coefficient is the coefficient of each term, whatever is free.
TEST(SplitSum, WeightsAndCoefficientsMultiplyToThoseOfTheTerms) {
  const Sum sum = four_terms();
  for (const auto &free : {std::vector<int>{kappa, nu}, {kappa}, {nu}, {}}) {
    const ParameterSpace parameters = space(free);
    Mu mu;
    for (const int i : free)
      mu.push_back(i == kappa ? 0.7 : 0.4);
    const FullMu all = expand(parameters, mu);
    const SplitSum split = split_sum(sum, parameters);
    const std::vector<double> theta = exact_coefficients(sum, split, parameters, all);
    const double lambda = 1 / (1 - 2 * all[nu]), shear = 1 / (1 + all[nu]);
    const double expected[] = {lambda, shear, all[kappa] * lambda, all[kappa] * shear};
    for (std::size_t q = 0; q < theta.size(); ++q)
      for (const auto &[term, weight] : split.exact[q].members)
        EXPECT_NEAR(weight * theta[q], expected[term], 1e-15 * expected[term]);
  }
}

TEST(SplitSum, TermsThatDependOnTheMapAreLeftOver) {
  Sum sum = four_terms();
  sum.insert(sum.begin() + 1, mapped_term({}, std::vector<int>{}));
  const SplitSum split = split_sum(sum, space({nu}));
  EXPECT_EQ(split.mapped, std::vector<int>{1});
  EXPECT_EQ(groups(split), (Groups{{0, 3}, {2, 4}}));
}

TEST(Sum, KnowsTheParametersThatItDependsOn) {
  Sum sum = four_terms();
  EXPECT_TRUE(depends_on(sum, kappa));
  EXPECT_FALSE(is_constant(sum, space({nu})));
  EXPECT_TRUE(is_constant(sum, space({})));
  sum.resize(2);
  EXPECT_FALSE(depends_on(sum, kappa));
  EXPECT_TRUE(is_constant(sum, space({kappa})));
  EXPECT_EQ(values_of_dependence(sum, {0.7, 0.3}), std::vector<double>{0.3});
  sum.push_back(mapped_term({}, std::vector<int>{kappa}));
  EXPECT_EQ(values_of_dependence(sum, {0.7, 0.3}), (std::vector<double>{0.7, 0.3}));
  EXPECT_TRUE(is_constant({mapped_term({}, std::vector<int>{kappa})}, space({nu})));
  EXPECT_FALSE(is_constant({mapped_term({})}, space({nu})));
}

TEST(Sum, ACoefficientThatIsNotFiniteIsNamed) {
  const Sum sum = four_terms();
  const ParameterSpace free = space({nu}),
                       fixed{{{"kappa", "", 0, 1, 1}, {"nu", "", 0, 1, 0.5}}, {0}};
  const char *says = "lambda is not finite at";
  EXPECT_TRUE(refuses(says, [&] {
    exact_coefficients(sum, split_sum(sum, free), free, {3, 0.5});
  }));
  EXPECT_TRUE(refuses(says, [&] { split_sum(sum, fixed); }));
  EXPECT_TRUE(refuses(says, [&] { check_coefficients(sum, free, {3, 0.5}); }));
}

} // namespace
} // namespace rbvi::terms_test
