// Planes of mirror symmetry that cut the domain out of the body. Every number that goes in or comes
// out is of the whole body, the domain with its images.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/formula.hpp"

#include <vector>

namespace rbvi {

/// Component `component` of a point is `position`, in the reference and in the mapped domain; the
/// domain is on one side.
struct MirrorPlane {
  int component = 0;
  double position = 0;
};

using MirrorPlanes = std::vector<MirrorPlane>;

/// Of the domain, itself among them.
int image_count(const MirrorPlanes &planes);
/// The images of each point of a part of the mesh: one on a plane is its own image there.
Vector image_counts(const MirrorPlanes &planes, const std::vector<Point> &points);
/// Whether the sum of a vector and its images has no such component.
bool cancels(const MirrorPlanes &planes, std::size_t component);
/// Whether the image of this number of a line, with the fields at its ends, is another line than
/// those of lower numbers: not where it lies on a plane.
bool has_image(const MirrorPlanes &planes, int image, const OutputFields &begin,
               const OutputFields &end);
/// Fields at a point become those at its image of this number, 0: itself.
void reflect(const MirrorPlanes &planes, int image, OutputFields &fields);

} // namespace rbvi
