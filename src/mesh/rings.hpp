// Meshes made of rings: rows of nodes along curves, and the strips of triangles between them.
#pragma once

#include "rbvi/mesh/mesh.hpp"

#include <functional>
#include <string>

namespace rbvi {

/// Nodes along a curve. A closed ring names its first node again at its end.
using Ring = std::vector<int>;

/// Appends the n nodes curve(0), curve(1/n), ..., curve((n - 1)/n) of a closed curve.
Ring add_closed_ring(SerialMesh &mesh, int n, const std::function<Point(double)> &curve);

/// Appends the n + 1 nodes curve(0), curve(1/n), ..., curve(1).
Ring add_open_ring(SerialMesh &mesh, int n, const std::function<Point(double)> &curve);

/// Appends the edges of a ring to the named boundary.
void add_facets(SerialMesh &mesh, const std::string &boundary, const Ring &ring);

/// Fills the strip between two rings that run in the same direction, both closed or both open, with
/// positively oriented triangles; `left` lies to the left of `right`. From the edge that joins the
/// two current nodes, either ring can go one node further: the better triangle of the two is taken.
/// Equal ones are told apart by a margin far above round-off, so that every machine makes the same
/// mesh.
void zip(SerialMesh &mesh, const Ring &left, const Ring &right);

/// Fills the strip with the best of all its triangulations instead of a step by step choice, for
/// rings whose nodes or distance vary; in time and memory the product of the nodes.
void zip_best(SerialMesh &mesh, const Ring &left, const Ring &right);

} // namespace rbvi
