// Which point of a sparse grid is worth most next (dimension-adaptive, Gerstner and Griebel 2003).
#pragma once

#include "rbvi/model/sparse_grid.hpp"

#include <map>
#include <vector>

namespace rbvi {

/// What grows by a point.
enum class Grows {
  interpolant, ///< by a coefficient: these decrease along each axis, and the smallest bound holds
  space        ///< by what its fields have outside: the largest of those of the points before;
               ///< four points along each axis alone are taken whatever is outside
};

class GrowingGrid {
public:
  GrowingGrid(const std::vector<GridAxis> &axes, Grows grows)
      : along_(axes), axes_(axes.size()), grows_(grows) {}
  /// `remainder`: what is missed at this point without it, relative.
  void take(const GridPoint &point, double remainder) { taken_[point] = remainder; }
  /// The points all of whose predecessors have been taken, with the remainder that is expected.
  std::map<GridPoint, double> candidates() const;

private:
  /// Along each axis the larger of the last two bounds the next one.
  double of_coefficient(const GridPoint &point) const;
  double of_space(const GridPoint &point) const;

  std::vector<GridAxis> along_;
  std::size_t axes_;
  Grows grows_;
  std::map<GridPoint, double> taken_;
};

/// The free parameters at a point, those without an axis as in `all_parameters`.
Mu free_parameters_at(const Scene &scene, const SparseGrid &grid, const GridPoint &point,
                      const FullMu &all_parameters);

} // namespace rbvi
