// The facets of a simplex, in an order of vertices that sees each outwards.
#pragma once

#include "rbvi/element/geometry.hpp"

namespace rbvi {

/// The cell with the vertices of one of its facets first, the opposite vertex last, of the same
/// orientation. `facet`: 0 .. dim.
Cell facet_cell(const Cell &cell, int facet);

/// Positions among the nodes of a cell (see Form) of those of a facet: nodes_per_cell(dim - 1,
/// degree) numbers, those of facet_cell's first vertices, then of the middles of their edges.
std::vector<int> facet_nodes(int dim, int degree, int facet);

struct FacetMeasure {
  double size = 0; ///< length or area
  Point normal{};  ///< unit, out of the cell
};

/// Of the facet of the first dim vertices of a positively oriented simplex, dim = 2 or 3.
FacetMeasure facet_measure(int dim, const std::array<Point, 4> &vertices);

} // namespace rbvi
