// A guess between scattered samples.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/parameters.hpp"

namespace rbvi {

/// The free parameters among all, as parts of the width of their box: coordinates of like size.
Vector parts_of_box(const ParameterSpace &space, const FullMu &all_parameters);
/// Columns of free parameters as such parts, d x P.
Matrix parts_of_box(const ParameterSpace &space, Matrix free);

/// Values at `here` of the affine function that fits those of the nearest samples, 2 (d + 1) of
/// them, best, weighted by the inverse square of their distance; of the nearest sample alone where
/// too few tell, or where the fit would extrapolate far. `values`: m x P, `points`: d x P, in
/// coordinates of like size. P > 0.
Vector local_fit(const Matrix &values, const Matrix &points, const Vector &here);

} // namespace rbvi
