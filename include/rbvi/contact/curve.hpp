// What interfaces along polygonal curves in 2D share.
#pragma once

#include "rbvi/contact/interface.hpp"

namespace rbvi {

/// Throws bad_input unless part `part` of the mesh is a curve: at least one edge, edge e from
/// vertex e to e + 1, x increasing. Returns its number of vertices.
Index check_curve(const InterfaceMesh &mesh, std::size_t part, const std::string &name);

/// Gram matrix in L2 of the polygon through `points` of its hat functions, `copies` blocks.
SparseMatrix linear_gram(const std::vector<Point> &points, int copies);

/// The polygon through these nodes of an interface, mapped, with the field "u" (motion + u). `u`:
/// at the nodes of the mesh.
Grid polyline(const Scene &scene, const FullMu &mu, const InterfaceMesh &mesh,
              const std::vector<Index> &nodes, const Vector &u);

/// Adds the field "pressure" to a polyline: one value for each node, or for each edge, then also at
/// the nodes, as the mean of the edges beside them weighted by length.
void add_pressure(const Vector &values, Grid &grid);

} // namespace rbvi
