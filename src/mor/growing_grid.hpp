// Which point of a sparse grid is worth most next (dimension-adaptive, Gerstner and Griebel 2003).
#pragma once

#include "rbvi/model/sparse_grid.hpp"

#include <map>
#include <vector>

namespace rbvi {

class GrowingGrid {
public:
  explicit GrowingGrid(std::size_t axes) : axes_(axes) {}
  /// `remainder`: what is missed at this point without it, relative.
  void take(const GridPoint &point, double remainder) { taken_[point] = remainder; }
  /// The points all of whose predecessors have been taken, with the remainder that is expected.
  std::map<GridPoint, double> candidates() const;

private:
  double expected(const GridPoint &point) const;

  std::size_t axes_;
  std::map<GridPoint, double> taken_;
};

/// The free parameters at a point, those without an axis as in `all_parameters`.
Mu free_parameters_at(const Scene &scene, const SparseGrid &grid, const GridPoint &point,
                      const FullMu &all_parameters);

} // namespace rbvi
