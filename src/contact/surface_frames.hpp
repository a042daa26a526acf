// The frames of the multipliers of a surface in space (frames.hpp), and the Gram matrix in them.
#pragma once

#include "frames.hpp"
#include "rbvi/contact/interface.hpp"

namespace rbvi {

/// Of the first `vertices` nodes of triangles, by the mean of the normals of the reference
/// triangles about each, weighted by their sizes, and by the axes along which the node is held.
/// Throws bad_input where the surface folds back on itself.
std::vector<Frame> reference_frames(const InterfaceMesh &mesh, Index vertices);

/// Of the hats of all vertices and, with friction, of hats along the tangents of their frames.
SparseMatrix surface_gram(const InterfaceMesh &mesh, const std::vector<Frame> &frames,
                          bool friction);

} // namespace rbvi
