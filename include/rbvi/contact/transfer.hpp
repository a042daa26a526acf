// From the multipliers of one mesh to those of another of the same scene.
#pragma once

#include "rbvi/contact/contact.hpp"

namespace rbvi {

/// The hat functions of the multipliers of `from` at those of `to`: to.dual_size() x
/// from.dual_size(), entries >= 0, rows of sum 1. Linear on edges and triangles whose nodes carry
/// multipliers; elsewhere the mean of the nearest dual nodes, two on curves and three on surfaces,
/// weighted by the inverse squares of their distances. Exact where the nodes coincide. Throws
/// failure if the interfaces are not the same ones. `wanted`: per interface of `to`; rows of other
/// nodes are empty.
SparseMatrix interpolation(const Contact &from, const Contact &to,
                           const std::vector<WantedNodes> &wanted = {});

} // namespace rbvi
