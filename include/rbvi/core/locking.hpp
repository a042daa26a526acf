// Elements of degree 1 lock where the material is nearly incompressible: they have too few
// displacements without a change of volume.
#pragma once

#include "rbvi/core/scene.hpp"

#include <ostream>

namespace rbvi {

/// The largest Poisson's ratio of the material at some points of the reference domain, where the
/// displacement is of degree 1 and locks, from 0.49 on; else 0. `all_parameters`: their values.
double locking_ratio(const Scene &scene, const FullMu &all_parameters,
                     const std::vector<Point> &points);

/// A line of warning with the remedy, unless the ratio is 0.
void warn_of_locking(double ratio, std::ostream &out);

} // namespace rbvi
