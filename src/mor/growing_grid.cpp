#include "growing_grid.hpp"

#include <algorithm>
#include <numeric>

namespace rbvi {

double GrowingGrid::of_coefficient(const GridPoint &point) const {
  if (std::accumulate(point.begin(), point.end(), 0) <= 2) return 1; // nothing is known before
  double least = 1;
  for (std::size_t d = 0; d < axes_; ++d) {
    double larger = 0; // one that is small by chance does not count
    GridPoint before = point;
    for (int back = 0; back < 2 && before[d] > 0; ++back) {
      --before[d];
      larger = std::max(larger, taken_.at(before));
    }
    if (point[d] > 0) least = std::min(least, larger);
  }
  return least;
}

double GrowingGrid::of_space(const GridPoint &point) const {
  // The middle and the ends are where samples often are: what they miss tells nothing.
  const int sum = std::accumulate(point.begin(), point.end(), 0);
  double largest = sum <= 3 && std::ranges::count(point, 0) >= std::ssize(point) - 1 ? 1 : 0;
  for (std::size_t d = 0; d < axes_; ++d) {
    GridPoint before = point;
    if (before[d]-- > 0) largest = std::max(largest, taken_.at(before));
  }
  return largest;
}

std::map<GridPoint, double> GrowingGrid::candidates() const {
  std::map<GridPoint, double> result;
  const auto add = [&](const GridPoint &point) {
    for (std::size_t d = 0; d < axes_; ++d) {
      GridPoint before = point;
      if (before[d]-- > 0 && !taken_.contains(before)) return;
    }
    if (!taken_.contains(point))
      result.emplace(point, grows_ == Grows::space ? of_space(point) : of_coefficient(point));
  };
  add(GridPoint(axes_, 0));
  for (const auto &[point, remainder] : taken_)
    for (std::size_t d = 0; d < axes_; ++d) {
      GridPoint after = point;
      if (++after[d] < along_[d].most) add(after);
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
