#include "rbvi/core/terms.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

bool contains(const std::vector<int> &list, int i) {
  return std::find(list.begin(), list.end(), i) != list.end();
}

bool varies(const Factor &factor, const ParameterSpace &space) {
  return std::any_of(factor.parameters.begin(), factor.parameters.end(),
                     [&](int i) { return contains(space.free, i); });
}

double value_of(const Factor &factor, const ParameterSpace &space, const FullMu &all_parameters) {
  const double value = factor.value(all_parameters);
  if (!std::isfinite(value))
    throw bad_input("the coefficient " + factor.name + " is not finite at " +
                    describe(space, all_parameters));
  return value;
}

/// Sorted, so that the order of factors does not matter.
std::vector<std::string> names_of(const std::vector<Factor> &factors,
                                  const std::vector<int> &which) {
  std::vector<std::string> names;
  for (const int i : which)
    names.push_back(factors[i].name);
  std::sort(names.begin(), names.end());
  return names;
}

/// The varying factors that every term has, a factor that they have twice twice.
std::vector<const Factor *> common_factors(const Sum &sum, const ParameterSpace &space) {
  std::vector<const Factor *> common;
  if (sum.empty() || !std::ranges::all_of(sum, [](const Term &term) { return !!term.theta; }))
    return common;
  for (const Factor &factor : *sum.front().theta)
    if (varies(factor, space)) common.push_back(&factor);
  for (const Term &term : sum) {
    std::vector<const Factor *> own;
    for (const Factor &factor : *term.theta)
      own.push_back(&factor);
    std::erase_if(common, [&](const Factor *factor) {
      const auto found = std::ranges::find(own, factor->name, &Factor::name);
      const bool missing = found == own.end();
      if (!missing) own.erase(found);
      return missing;
    });
  }
  return common;
}

const std::vector<Factor> &factors_of(const Sum &sum, int term) {
  return *sum[term].theta;
}

} // namespace

Term exact_term(Form form, std::vector<Factor> factors) {
  return {std::move(form), std::move(factors)};
}

Term mapped_term(Form form, std::optional<std::vector<int>> parameters) {
  return {std::move(form), std::nullopt, std::move(parameters)};
}

double coefficient_of(const Term &term, const FullMu &all_parameters) {
  double product = 1;
  for (const Factor &factor : *term.theta)
    product *= factor.value(all_parameters);
  return product;
}

SplitSum split_sum(const Sum &sum, const ParameterSpace &space) {
  FullMu fixed;
  for (const Parameter &p : space.all)
    fixed.push_back(p.value);
  SplitSum split;
  std::vector<std::vector<std::string>> names; // of the varying factors of each group
  for (int t = 0; t < static_cast<int>(sum.size()); ++t) {
    if (!sum[t].theta) {
      split.mapped.push_back(t);
      continue;
    }
    const std::vector<Factor> &factors = factors_of(sum, t);
    std::vector<int> varying;
    double weight = 1;
    for (int i = 0; i < static_cast<int>(factors.size()); ++i) {
      const Factor &factor = factors[i];
      if (varies(factor, space))
        varying.push_back(i);
      else
        weight *= value_of(factor, space, fixed);
    }
    const std::vector<std::string> own = names_of(factors, varying);
    const auto found = std::find(names.begin(), names.end(), own);
    if (found != names.end()) {
      split.exact[found - names.begin()].members.push_back({t, weight});
      continue;
    }
    const auto at = varying.empty() ? 0 : std::ssize(names);
    names.insert(names.begin() + at, own);
    split.exact.insert(split.exact.begin() + at, {{{t, weight}}, varying});
  }
  return split;
}

std::vector<double> exact_coefficients(const Sum &sum, const SplitSum &split,
                                       const ParameterSpace &space, const FullMu &all_parameters) {
  std::vector<double> result;
  for (const ExactGroup &group : split.exact) {
    double product = 1;
    for (const int i : group.factors)
      product *= value_of(factors_of(sum, group.members.front().term)[i], space, all_parameters);
    result.push_back(product);
  }
  return result;
}

double common_coefficient(const Sum &sum, const ParameterSpace &space,
                          const FullMu &all_parameters) {
  double product = 1;
  for (const Factor *factor : common_factors(sum, space))
    product *= value_of(*factor, space, all_parameters);
  return product;
}

std::vector<int> parameters_beside_common(const Sum &sum, const ParameterSpace &space) {
  Sum rest = sum;
  for (const Factor *factor : common_factors(sum, space))
    for (Term &term : rest)
      term.theta->erase(std::ranges::find(*term.theta, factor->name, &Factor::name));
  std::vector<int> parameters = space.free;
  std::erase_if(parameters, [&](int i) { return !depends_on(rest, i); });
  return parameters;
}

bool depends_on(const Sum &sum, int parameter) {
  return std::any_of(sum.begin(), sum.end(), [&](const Term &term) {
    if (!term.theta) return !term.parameters || contains(*term.parameters, parameter);
    return std::any_of(term.theta->begin(), term.theta->end(), [&](const Factor &factor) {
      return contains(factor.parameters, parameter);
    });
  });
}

bool is_constant(const Sum &sum, const ParameterSpace &space) {
  return std::none_of(space.free.begin(), space.free.end(),
                      [&](int i) { return depends_on(sum, i); });
}

std::vector<double> values_of_dependence(const Sum &sum, const FullMu &all_parameters) {
  std::vector<double> values;
  for (std::size_t i = 0; i < all_parameters.size(); ++i)
    if (depends_on(sum, static_cast<int>(i))) values.push_back(all_parameters[i]);
  return values;
}

void check_coefficients(const Sum &sum, const ParameterSpace &space, const FullMu &all_parameters) {
  for (const Term &term : sum)
    for (std::size_t i = 0; term.theta && i < term.theta->size(); ++i)
      (void)value_of((*term.theta)[i], space, all_parameters);
}

} // namespace rbvi
