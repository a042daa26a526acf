// Interpolation of the snapshots themselves: the least that a reduced model must beat.
#pragma once

#include "rbvi/sweep/sweep.hpp"

#include <utility>
#include <vector>

namespace rbvi {

/// How a set of parameters is arranged.
struct TrainingGrid {
  /// Increasing values of each parameter, if the set is their product with the last parameter
  /// fastest; empty otherwise.
  std::vector<std::vector<double>> ticks;
};

TrainingGrid find_grid(const std::vector<Mu> &set);

/// Numbers in `set` and their weights, which sum to 1: multilinear on a grid (linear beyond its
/// ends), else the nearest mu, distances relative to the box.
std::vector<std::pair<std::size_t, double>> interpolation_weights(const TrainingGrid &grid,
                                                                  const std::vector<Mu> &set,
                                                                  const ParameterSpace &space,
                                                                  const Mu &mu);

} // namespace rbvi
