#include "rbvi/element/facets.hpp"

#include "rbvi/element/lagrange.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// Even permutations of the vertices of a triangle and of a tetrahedron.
constexpr std::array<std::array<int, 4>, 3> of_triangle{{{0, 1, 2, 3}, {1, 2, 0, 3}, {2, 0, 1, 3}}};
constexpr std::array<std::array<int, 4>, 4> of_tetrahedron{
    {{0, 1, 2, 3}, {0, 3, 1, 2}, {1, 3, 2, 0}, {0, 2, 3, 1}}};

const std::array<int, 4> &order_of(int dim, int facet) {
  const auto number = static_cast<std::size_t>(facet);
  return dim == 2 ? of_triangle[number] : of_tetrahedron[number];
}

} // namespace

Cell facet_cell(const Cell &cell, int facet) {
  Cell result{cell.dim, {}, {}};
  for (int i = 0; i <= cell.dim; ++i) {
    const auto from = static_cast<std::size_t>(order_of(cell.dim, facet)[i]);
    result.reference[i] = cell.reference[from];
    result.mapped[i] = cell.mapped[from];
  }
  return result;
}

std::vector<int> facet_nodes(int dim, int degree, int facet) {
  const auto &order = order_of(dim, facet);
  std::vector<int> nodes(order.begin(), order.begin() + dim);
  if (degree == 1) return nodes;
  for (std::size_t e = 0; e < (dim == 2 ? 1U : 3U); ++e) {
    const std::array<int, 2> ends{order[simplex_edges[e][0]], order[simplex_edges[e][1]]};
    const auto edge = std::find_if(simplex_edges.begin(), simplex_edges.end(), [&](const auto &of) {
      return of == ends || (of[0] == ends[1] && of[1] == ends[0]);
    });
    nodes.push_back(dim + 1 + static_cast<int>(edge - simplex_edges.begin()));
  }
  return nodes;
}

FacetMeasure facet_measure(int dim, const std::array<Point, 4> &vertices) {
  const Point first = vertices[1] - vertices[0];
  const Point outwards =
      dim == 2 ? Point{first[1], -first[0], 0} : cross(vertices[2] - vertices[0], first) / 2;
  const double size = norm(outwards);
  return {size, outwards / size};
}

} // namespace rbvi
