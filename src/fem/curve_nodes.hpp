// The nodes of a boundary that is a graph over x, gathered from all ranks.
#pragma once

#include "rbvi/fem/dofs.hpp"

#include <string>
#include <vector>

namespace rbvi {

struct CurveNode {
  PetscInt natural;
  Point point;
  PetscInt fixed; ///< bit c: component c is, of those asked for
};

/// Everybody's owned nodes on a boundary: vertices and then middles of edges, each by increasing x.
/// `components`: those that contact moves; `may_be_fixed`: at some nodes. Throws bad_input where
/// there are fewer than 2 vertices, two nodes have the same x, or one is fixed that may not be.
/// Collective.
std::vector<CurveNode> gather_curve(const Mesh &mesh, const Dofs &dofs, const std::string &boundary,
                                    const std::vector<int> &components, bool may_be_fixed);

} // namespace rbvi
