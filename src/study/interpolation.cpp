#include "rbvi/study/interpolation.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

std::size_t nearest(const std::vector<Mu> &set, const ParameterSpace &space, const Mu &mu) {
  const auto distance = [&](const Mu &other) {
    double sum = 0;
    for (std::size_t i = 0; i < mu.size(); ++i) {
      const Parameter &parameter = space.at(static_cast<int>(i));
      sum += std::pow((mu[i] - other[i]) / (parameter.upper - parameter.lower), 2);
    }
    return sum;
  };
  const auto closer = [&](const Mu &a, const Mu &b) { return distance(a) < distance(b); };
  return static_cast<std::size_t>(std::min_element(set.begin(), set.end(), closer) - set.begin());
}

} // namespace

TrainingGrid find_grid(const std::vector<Mu> &set) {
  TrainingGrid grid{std::vector<std::vector<double>>(set.front().size())};
  for (std::size_t i = 0; i < grid.ticks.size(); ++i) {
    std::vector<double> &ticks = grid.ticks[i];
    for (const Mu &mu : set)
      ticks.push_back(mu[i]);
    std::sort(ticks.begin(), ticks.end());
    ticks.erase(std::unique(ticks.begin(), ticks.end()), ticks.end());
  }
  std::vector<Mu> product{{}};
  for (const std::vector<double> &ticks : grid.ticks) {
    if (product.size() * ticks.size() > set.size()) return {};
    std::vector<Mu> finer;
    for (const Mu &mu : product)
      for (const double tick : ticks) {
        finer.push_back(mu);
        finer.back().push_back(tick);
      }
    product = std::move(finer);
  }
  return product == set ? grid : TrainingGrid{};
}

std::vector<std::pair<std::size_t, double>> interpolation_weights(const TrainingGrid &grid,
                                                                  const std::vector<Mu> &set,
                                                                  const ParameterSpace &space,
                                                                  const Mu &mu) {
  if (grid.ticks.empty()) return {{nearest(set, space, mu), 1.0}};
  std::vector<std::pair<std::size_t, double>> weights{{0, 1.0}};
  for (std::size_t i = 0; i < mu.size(); ++i) {
    const std::vector<double> &ticks = grid.ticks[i];
    std::size_t upper = 0;
    double fraction = 1;
    if (ticks.size() > 1) {
      upper = static_cast<std::size_t>(std::upper_bound(ticks.begin() + 1, ticks.end() - 1, mu[i]) -
                                       ticks.begin());
      fraction = (mu[i] - ticks[upper - 1]) / (ticks[upper] - ticks[upper - 1]);
    }
    std::vector<std::pair<std::size_t, double>> finer;
    for (const auto &[number, weight] : weights) {
      finer.emplace_back(number * ticks.size() + upper, weight * fraction);
      if (ticks.size() > 1)
        finer.emplace_back(number * ticks.size() + upper - 1, weight * (1 - fraction));
    }
    weights = std::move(finer);
  }
  return weights;
}

} // namespace rbvi
