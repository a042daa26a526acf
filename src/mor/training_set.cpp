// What a reduction asks of its training set.
#include "rbvi/mor/reduce.hpp"

#include "rbvi/core/box.hpp"
#include "rbvi/core/error.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

Mu box_centre(const ParameterSpace &space) {
  Mu mu;
  for (int i = 0; i < space.size(); ++i)
    mu.push_back(taken(space.at(i), (space.at(i).lower + space.at(i).upper) / 2));
  return mu;
}

bool holds_corners(const ParameterSpace &space, const std::vector<Mu> &training) {
  const auto is_at = [&](const Mu &mu, const Mu &other) {
    for (int i = 0; i < space.size(); ++i) {
      const Parameter &p = space.at(i);
      const auto k = static_cast<std::size_t>(i);
      if (!(std::abs(mu[k] - other[k]) <= 1e-9 * (p.upper - p.lower))) return false;
    }
    return true;
  };
  for (unsigned long bits = 0; bits < 1UL << space.size(); ++bits)
    if (std::ranges::none_of(training,
                             [&](const Mu &mu) { return is_at(mu, corner(space, bits)); }))
      return false;
  return true;
}

Matrix multipliers_of(const std::vector<Sample> &samples) {
  if (samples.empty()) throw failure("there is no sample to build a basis from");
  Matrix lambda(samples.front().lambda.size(), std::ssize(samples));
  for (std::size_t p = 0; p < samples.size(); ++p)
    lambda.col(p) = samples[p].lambda;
  if ((lambda.array() == 0).all())
    throw failure(
        "all multipliers are zero: there is no contact at any training mu, and nothing to "
        "reduce; widen the parameter box or move the obstacle");
  return lambda;
}

} // namespace rbvi
