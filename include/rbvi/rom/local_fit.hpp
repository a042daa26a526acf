// A guess between scattered samples.
#pragma once

#include "rbvi/core/dense.hpp"

namespace rbvi {

/// Values at `here` of the affine function that fits those of the nearest samples, 2 (d + 1) of
/// them, best, weighted by the inverse square of their distance; of the nearest sample alone where
/// too few tell, or where the fit would extrapolate far. `values`: m x P, `points`: d x P, in
/// coordinates of like size. P > 0.
Vector local_fit(const Matrix &values, const Matrix &points, const Vector &here);

} // namespace rbvi
