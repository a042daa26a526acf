// Where elements are known to be wrong: those of degree 1 lock where the material is nearly
// incompressible, as they have too few displacements without a change of volume; multipliers over a
// region overshoot unless the constraint is one of single nodes.
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

/// Lines of warning with the remedy, where `ratio` is one that locks (not 0), and of a scene with
/// contact over a region by exact quadrature.
void warn_of_elements(const Scene &scene, double ratio, std::ostream &out);

} // namespace rbvi
