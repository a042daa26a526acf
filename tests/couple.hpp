// The operators of vertical pairing in the vertical displacements of the nodes.
#pragma once

#include "rbvi/contact/contact_pair.hpp"

namespace rbvi {

/// Columns are the vertical displacements of the slave nodes, then of the master nodes, each in the
/// order of their curve.
inline PairOperators couple(const std::vector<Point> &slave, const std::vector<Point> &master,
                            const PairDiscretisation &discretisation, int degree = 1) {
  std::vector<int> dofs;
  for (int i = 0; i < static_cast<int>(slave.size() + master.size()); ++i)
    dofs.insert(dofs.end(), {-1, i});
  const NodalCurve upper(slave, degree), lower(master, degree);
  const NodalCurve above = as_graph(upper, "slave"), below = as_graph(lower, "master");
  const std::vector<CurveSection> sections = sections_of(below, true);
  PairDiscretisation how = discretisation;
  how.projection = PairProjection::vertical;
  return pair_operators(
      find_partners(above, below, how, {sections, vertical_normals(below), true}, upper.hats(false)),
      PairMultipliers(upper.shape(), how.multiplier, degree), dofs, std::ssize(dofs) / 2, false);
}

/// Of a slave curve of so many nodes in one open piece.
inline PairMultipliers multipliers_of(Index slave_nodes, MultiplierSpace space, int degree = 1) {
  return {CurveShape({{0, (slave_nodes - 1) / degree, 0}}), space, degree};
}
inline Index multiplier_count(Index slave_nodes, MultiplierSpace space, int degree = 1) {
  return multipliers_of(slave_nodes, space, degree).count();
}
inline Index macro_edge_of(Index edge, Index slave_nodes, int degree = 1) {
  return multipliers_of(slave_nodes, MultiplierSpace::macro_edges, degree).on_edge(edge)[0];
}
inline SparseMatrix multiplier_product(const std::vector<Point> &slave, MultiplierSpace space,
                                       int degree = 1) {
  return multipliers_of(std::ssize(slave), space, degree)
      .gram(as_graph({slave, degree}, "slave"), 1);
}
inline std::vector<Point> multiplier_points(const std::vector<Point> &slave, MultiplierSpace space,
                                            int degree = 1) {
  return multipliers_of(std::ssize(slave), space, degree)
      .points(as_graph({slave, degree}, "slave"));
}

} // namespace rbvi
