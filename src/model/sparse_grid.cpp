#include "rbvi/model/sparse_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rbvi {

namespace {

/// Of a modulus on [1, 3] the linear coordinate needs 17 points to 1e-9; beyond that the logarithm
/// needs fewer.
bool is_wide(const Parameter &parameter) {
  return parameter.lower > 0 && parameter.upper > 3 * parameter.lower;
}

} // namespace

double coordinate_at(const Scene &scene, int parameter, double value) {
  const auto choices = static_cast<int>(scene.parameters.all[parameter].choices.size());
  if (choices > 0) return leja_points(choices)[static_cast<Index>(value)];
  if (const Coordinate *own = coordinate_of(scene, parameter)) return own->of(value);
  return is_wide(scene.parameters.all[parameter]) ? std::log(value) : value;
}

double value_back(const Scene &scene, int parameter, double coordinate) {
  const auto choices = static_cast<int>(scene.parameters.all[parameter].choices.size());
  if (choices > 0) {
    Index nearest = 0;
    (leja_points(choices).array() - coordinate).abs().minCoeff(&nearest);
    return static_cast<double>(nearest);
  }
  if (const Coordinate *own = coordinate_of(scene, parameter)) return own->back(coordinate);
  return is_wide(scene.parameters.all[parameter]) ? std::exp(coordinate) : coordinate;
}

GridAxis axis_of(const Scene &scene, int parameter) {
  const Parameter &p = scene.parameters.all[parameter];
  if (!p.choices.empty()) return {parameter, -1, 1, static_cast<int>(p.choices.size())};
  const auto [lower, upper] = std::minmax(
      {coordinate_at(scene, parameter, p.lower), coordinate_at(scene, parameter, p.upper)});
  return {parameter, lower, upper};
}

Index SparseGrid::size() const {
  return axes.empty() ? 1 : std::ssize(points) / std::ssize(axes);
}

void SparseGrid::append(const GridPoint &point) {
  points.insert(points.end(), point.begin(), point.end());
}

Vector leja_points(int count) {
  constexpr int candidates = 512;
  Vector x(candidates + 1);
  for (int k = 0; k <= candidates; ++k)
    x[k] = std::cos(std::numbers::pi * k / candidates);
  x[candidates / 2] = 0;
  Vector points = Vector::Zero(count), products = x.cwiseAbs();
  for (int i = 1; i < count; ++i) {
    Index best = 0;
    for (Index k = 1; k < x.size(); ++k) // of those that are as far the first
      if (products[k] > products[best] * (1 + 1e-12)) best = k;
    points[i] = x[best];
    products.array() *= (x.array() - points[i]).abs();
  }
  return points;
}

FullMu parameters_at(const Scene &scene, const SparseGrid &grid, const GridPoint &point,
                     const FullMu &all_parameters) {
  FullMu all = all_parameters;
  for (std::size_t d = 0; d < grid.axes.size(); ++d) {
    const auto &[parameter, lower, upper, most] = grid.axes[d];
    const double x = (lower + upper) / 2 + (upper - lower) / 2 * grid.abscissae[point[d]];
    all[parameter] = value_back(scene, parameter, x);
  }
  return all;
}

Vector grid_functions(const Scene &scene, const SparseGrid &grid, const FullMu &all_parameters) {
  const Index axes = std::ssize(grid.axes), count = grid.abscissae.size();
  Vector functions = Vector::Ones(grid.size());
  for (Index d = 0; d < axes; ++d) {
    const auto &[parameter, lower, upper, most] = grid.axes[d];
    const double coordinate = coordinate_at(scene, parameter, all_parameters[parameter]);
    const double x = (2 * coordinate - lower - upper) / (upper - lower);
    Vector along = Vector::Ones(count);
    for (Index k = 0; k < count; ++k)
      for (Index j = 0; j < k; ++j)
        along[k] *= (x - grid.abscissae[j]) / (grid.abscissae[k] - grid.abscissae[j]);
    for (Index p = 0; p < functions.size(); ++p)
      functions[p] *= along[grid.points[p * axes + d]];
  }
  return functions;
}

} // namespace rbvi
