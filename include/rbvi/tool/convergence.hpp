// What values on meshes with halved edges tell of the limit.
#pragma once

#include <optional>
#include <vector>

namespace rbvi {

struct Convergence {
  /// From the third mesh on, those of the difference to the mesh before over the difference before;
  /// nothing where these have different signs, or one is round-off, or edges are not cut alike.
  std::vector<std::optional<double>> orders{};
  /// The limit, were the last order that of all finer meshes; nothing where it is not positive.
  std::optional<double> richardson{};
};

/// An output on meshes whose edges were halved so many times.
Convergence convergence_of(const std::vector<double> &values, const std::vector<int> &refinements);

} // namespace rbvi
