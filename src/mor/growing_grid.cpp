#include "growing_grid.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace rbvi {

/// Along each axis remainders decrease, but for single ones that are small by chance: the larger of
/// the last two bounds the next one, and so does the least of these over the axes. Points of degree
/// two are taken in any case, as nothing is known before.
double GrowingGrid::expected(const GridPoint &point) const {
  if (std::accumulate(point.begin(), point.end(), 0) <= 2) return 1;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t d = 0; d < axes_; ++d) {
    double larger = 0;
    GridPoint before = point;
    for (int back = 0; back < 2 && before[d] > 0; ++back) {
      --before[d];
      larger = std::max(larger, taken_.at(before));
    }
    if (point[d] > 0) least = std::min(least, larger);
  }
  return least;
}

std::map<GridPoint, double> GrowingGrid::candidates() const {
  std::map<GridPoint, double> result;
  const auto add = [&](const GridPoint &point) {
    for (std::size_t d = 0; d < axes_; ++d) {
      GridPoint before = point;
      if (before[d]-- > 0 && !taken_.contains(before)) return;
    }
    if (!taken_.contains(point)) result.emplace(point, expected(point));
  };
  add(GridPoint(axes_, 0));
  for (const auto &[point, remainder] : taken_)
    for (std::size_t d = 0; d < axes_; ++d) {
      GridPoint after = point;
      ++after[d];
      add(after);
    }
  return result;
}

Mu free_parameters_at(const Scene &scene, const SparseGrid &grid, const GridPoint &point,
                      const FullMu &all_parameters) {
  const FullMu all = parameters_at(scene, grid, point, all_parameters);
  Mu mu;
  for (const int i : scene.parameters.free)
    mu.push_back(all[i]);
  return mu;
}

} // namespace rbvi
