// Distances from the places where the parts of a mesh must lie (MeshFact::distance), in the plane.
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

using Place = std::function<double(const Point &)>;

// Filled places: the distance outside, the negative depth inside.

/// [low x, high x] x [low y, high y].
Place box(const Point &low, const Point &high);
/// Disk.
Place disk(const Point &centre, double radius);
/// What lies in both: exact inside and on the rim, at most the distance outside.
Place common_part(const Place &a, const Place &b);

// Curves: the distance, >= 0.

/// Rim of a filled place.
Place rim(const Place &filled);
/// From `a` to `b`.
Place segment(const Point &a, const Point &b);
/// Points of a circle within `half_angle` <= pi of the direction (cos angle, sin angle).
Place arc(const Point &centre, double radius, double angle, double half_angle);

/// The nearest of some places.
Place nearest(std::vector<Place> places);

} // namespace rbvi
