// The box of the free parameters: its boundary, and a guess between scattered samples in it.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/parameters.hpp"

namespace rbvi {

/// The corner that has the upper bound of free parameter i where bit i of `bits` is set.
Mu corner(const ParameterSpace &space, unsigned long bits);

/// The corners of the box and the centres of its faces, corners first. Of more than five parameters
/// 32 corners, among which every pair of bounds of two parameters is equally frequent (up to 31
/// parameters).
std::vector<Mu> corners_and_faces(const ParameterSpace &space);

/// Whether `mu` is nearer to its nearest corner, or to some face, than any of `set` (free
/// parameters x P, P > 0), in parts of the box.
bool nearer_to_boundary(const ParameterSpace &space, const Matrix &set, const Mu &mu);

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
