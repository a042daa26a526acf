#include "rbvi/study/interpolation.hpp"

#include "rbvi/core/box.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

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

namespace {

using Weights = std::vector<std::pair<std::size_t, double>>;

Weights multilinear(const TrainingGrid &grid, const Mu &mu) {
  Weights weights{{0, 1.0}};
  for (std::size_t i = 0; i < mu.size(); ++i) {
    const std::vector<double> &ticks = grid.ticks[i];
    std::size_t upper = 0;
    double fraction = 1;
    if (ticks.size() > 1) {
      upper = static_cast<std::size_t>(std::upper_bound(ticks.begin() + 1, ticks.end() - 1, mu[i]) -
                                       ticks.begin());
      fraction = (mu[i] - ticks[upper - 1]) / (ticks[upper] - ticks[upper - 1]);
    }
    Weights finer;
    for (const auto &[number, weight] : weights) {
      finer.emplace_back(number * ticks.size() + upper, weight * fraction);
      if (ticks.size() > 1)
        finer.emplace_back(number * ticks.size() + upper - 1, weight * (1 - fraction));
    }
    weights = std::move(finer);
  }
  return weights;
}

/// At these points (columns): |x - x_j|^3 of all x_j, then 1 and the coordinates.
Matrix functions_at(const Matrix &points, const Matrix &at) {
  const Index count = points.cols();
  Matrix values(count + 1 + points.rows(), at.cols());
  for (Index k = 0; k < at.cols(); ++k)
    values.col(k) << (points.colwise() - at.col(k)).colwise().norm().array().cube().transpose(), 1,
        at.col(k);
  return values;
}

} // namespace

SampleInterpolation::SampleInterpolation(const ParameterSpace &space, const std::vector<Mu> &set)
    : space_(space), grid_(find_grid(set)) {
  if (on_grid()) return;
  points_.resize(space.size(), std::ssize(set));
  for (Index j = 0; j < points_.cols(); ++j)
    points_.col(j) = parts_of_box(space, expand(space, set[j]));
  centre_ = points_.rowwise().mean();
  points_.colwise() -= centre_;
  const Index count = points_.cols(), linear = 1 + points_.rows();
  Matrix conditions = Matrix::Zero(count + linear, count + linear);
  conditions.leftCols(count) = functions_at(points_, points_);
  conditions.topRightCorner(count, linear) = conditions.bottomLeftCorner(linear, count).transpose();
  conditions_.compute(conditions); // of least norm where samples repeat or lie in a plane
}

Weights SampleInterpolation::weights(const Mu &mu) const {
  if (on_grid()) return multilinear(grid_, mu);
  const Vector at = parts_of_box(space_, expand(space_, mu)) - centre_;
  const Vector solved = conditions_.solve(functions_at(points_, at));
  Weights weights;
  for (Index j = 0; j < points_.cols(); ++j)
    weights.emplace_back(j, solved[j]);
  return weights;
}

} // namespace rbvi
