// Contact of two bodies along two polygonal curves in 2D, with vertical pairing: the partner of a
// point x of the slave (upper) curve is the point phi(x) of the master (lower) curve with the same
// abscissa. The displacements of both satisfy
//
//   (u_master o phi - u_slave) . e_y <= gap = (x - phi(x)) . e_y,
//
// which is (2.49) with the slave on top. A curve is its nodes in the order of strictly increasing
// abscissa; in every function of this file a curve of less than 2 nodes or of another order throws
// bad_input, naming the curve and the node.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/scene.hpp"

namespace rbvi {

/// The constraint, weak and at nodes. Columns are the vertical displacements of the slave nodes,
/// then of the master nodes, each in the order of their curve; eta are the basis functions of the
/// multipliers. A slave point beyond the ends of the master curve has no partner and contributes
/// nothing.
struct PairOperators {
  SparseMatrix b;            ///< multipliers x nodes: int (v_master o phi - v_slave) eta ds (2.51)
  Vector g;                  ///< multipliers: int gap eta ds (2.52)
  Vector weights;            ///< multipliers: int eta ds over the slave points that have a partner
  std::vector<Index> paired; ///< slave nodes that have a partner, increasing
  SparseMatrix nodal_b;      ///< paired x nodes: the constraint at these nodes
  Vector nodal_gap;          ///< paired
};

/// Number of multipliers on a slave curve of at least 2 nodes. Macro-edges: two edges each, the
/// last takes a third if their number is odd.
Index multiplier_count(Index slave_nodes, MultiplierSpace space);

/// The macro-edge that holds a slave edge.
Index macro_edge_of(Index edge, Index slave_nodes);

/// Integrals are in arc length of the slave curve. O(slave + master nodes).
PairOperators couple(const std::vector<Point> &slave, const std::vector<Point> &master,
                     const PairDiscretisation &discretisation);

/// The same for a scene with a pair: its curves mapped by h(mu), its motion taken into both gaps.
/// `points`: reference nodes of the slave curve, then of the master curve. Throws failure, naming
/// mu, if the map leaves no curve.
PairOperators couple_at(const Scene &scene, const Mu &all_parameters,
                        const std::vector<Point> &points, Index slave_nodes);

/// Gram matrix of the multipliers in L2 of the slave curve; an entry (possibly zero) for every pair
/// of neighbours.
SparseMatrix multiplier_product(const std::vector<Point> &slave, MultiplierSpace space);

/// Where a multiplier is drawn: the middle of its macro-edge, by arc length, or its node.
std::vector<Point> multiplier_points(const std::vector<Point> &slave, MultiplierSpace space);

} // namespace rbvi
