// Lagrange functions of degree 1 and 2 on a simplex. Nodes: the vertices, then (degree 2) the
// middles of the edges, in the order of quadratic VTK cells.
#pragma once

#include "rbvi/element/geometry.hpp"

#include <span>

namespace rbvi {

/// Throws bad_input unless it is 1 or 2.
void check_degree(int degree);

/// Nodes of a cell: dim + 1 of degree 1, (dim + 1) (dim + 2) / 2 of degree 2; dim = 1, 2, 3.
int nodes_per_cell(int dim, int degree);

inline constexpr int most_nodes = 10; ///< of any cell

/// The two vertices of each edge: (0,1), (1,2), (2,0), (0,3), (1,3), (2,3); a simplex of dim 2 has
/// the first three, of dim 1 the first.
inline constexpr std::array<std::array<int, 2>, 6> simplex_edges{
    {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

/// Values at a point: nodes_per_cell numbers.
void lagrange_values(int dim, int degree, std::span<const double> barycentric,
                     std::span<double> values);

/// Gradients at a point: node x direction, from those of the barycentric functions.
void lagrange_gradients(int dim, int degree, std::span<const double> barycentric,
                        const Simplex &simplex, std::span<std::array<double, 3>> gradients);

} // namespace rbvi
