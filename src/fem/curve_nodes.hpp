// The nodes of a boundary that is a graph over x, gathered from all ranks.
#pragma once

#include "rbvi/fem/dofs.hpp"

#include <string>
#include <vector>

namespace rbvi {

struct CurveNode {
  PetscInt natural;
  Point point;
  bool fixed; ///< one of the components asked for is imposed
};

/// Everybody's owned nodes on a boundary: vertices and then middles of edges, each by increasing x.
/// `components`: those that must be free. Throws bad_input where there are fewer than 2 vertices,
/// two nodes have the same x, or a component is fixed. Collective.
std::vector<CurveNode> gather_curve(const Mesh &mesh, const Dofs &dofs, const std::string &boundary,
                                    const std::vector<int> &components);

} // namespace rbvi
