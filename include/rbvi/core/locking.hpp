// Elements of degree 1 lock where the material is nearly incompressible: they have too few
// displacements without a change of volume.
#pragma once

#include "rbvi/core/scene.hpp"

#include <ostream>

namespace rbvi {

/// A point of the reference domain in a material of the scene, by its number.
struct MaterialPoint {
  Point x;
  int material = 0;
};

/// The largest Poisson's ratio at some points, where the displacement is of degree 1 and locks,
/// from 0.48 on; else 0. `all_parameters`: their values.
double locking_ratio(const Scene &scene, const FullMu &all_parameters,
                     const std::vector<MaterialPoint> &points);

/// A line of warning with the remedy, unless the ratio is 0.
void warn_of_locking(double ratio, std::ostream &out);

} // namespace rbvi
