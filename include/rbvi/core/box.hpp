// The boundary of the box of the free parameters.
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

} // namespace rbvi
