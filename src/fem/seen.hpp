// What interfaces see of the nodes and cells of a distributed mesh, whole on every rank.
#pragma once

#include "rbvi/fem/dofs.hpp"
#include "rbvi/mesh/mesh.hpp"

#include <algorithm>

namespace rbvi {

/// A cell, or a facet of it, that an interface sees: the number of the cell in the undistributed
/// mesh, its edge on a boundary or which facet it is (-1: none), the nodes.
struct SeenCell {
  PetscInt number, edge;
  std::array<int, most_nodes> nodes;
};

/// Nodes of all ranks by increasing natural number; `fixed`: a bit for each component.
struct SeenNodes {
  std::vector<PetscInt> natural, fixed;
  std::vector<Point> points;
  Index position(PetscInt number) const {
    return std::ranges::lower_bound(natural, number) - natural.begin();
  }
  const Point &at(PetscInt number) const { return points[position(number)]; }
};

struct SeenCells {
  std::vector<SeenCell> cells;
  SeenNodes nodes;
};

/// From this rank's nodes, some of them many times; those on the border of several ranks come from
/// each of them. Collective.
SeenNodes gather_nodes(const Mesh &mesh, const Dofs &dofs, std::vector<int> mine);

/// `mine`: with so many of this rank's local nodes each. Collective.
SeenCells gather_cells(const Mesh &mesh, const Dofs &dofs, const std::vector<SeenCell> &mine,
                       int per_cell);

/// What contact sees of a boundary: its nodes, and the middle of the edge that begins at a vertex.
struct SeenCurve {
  SeenNodes nodes;
  std::map<PetscInt, PetscInt> middle;
};
/// Collective.
SeenCurve gather_curve(const Mesh &mesh, const Dofs &dofs, const std::string &boundary);

/// Moves the middles of edges of a boundary onto the scene's curves that have these edges.
/// Collective.
void move_middles(const Mesh &mesh, const Scene &scene, const std::string &boundary,
                  SeenNodes &nodes);

} // namespace rbvi
