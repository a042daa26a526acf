// Interpolation of the snapshots themselves: the least that a reduced model must beat.
#pragma once

#include "rbvi/sweep/sweep.hpp"

#include <Eigen/QR>

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

/// Values at a set of parameters, of which those elsewhere are sums. On a grid multilinear (linear
/// beyond its ends); else by cubic radial functions and a linear polynomial,
///
///   s(mu) = sum_j c_j |mu - mu_j|^3 + p(mu),   sum_j c_j q(mu_j) = 0 for all linear q,
///
/// distances relative to the box.
class SampleInterpolation {
public:
  /// The set must not be empty.
  SampleInterpolation(const ParameterSpace &space, const std::vector<Mu> &set);

  /// Numbers in the set and their weights, which sum to 1.
  std::vector<std::pair<std::size_t, double>> weights(const Mu &mu) const;
  bool on_grid() const { return !grid_.ticks.empty(); }

private:
  const ParameterSpace &space_;
  TrainingGrid grid_;
  Matrix points_; ///< parameters x set, as parts of the box about their centre; of scattered ones
  Vector centre_;
  Eigen::CompleteOrthogonalDecomposition<Matrix> conditions_; ///< of c and of p
};

} // namespace rbvi
