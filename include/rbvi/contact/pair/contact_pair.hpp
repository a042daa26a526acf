// Contact of two bodies along two curves in 2D, with vertical pairing: the partner of a point x of
// the slave (upper) curve is the point phi(x) of the master (lower) curve with the same abscissa.
// The displacements of both satisfy
//
//   (u_master o phi - u_slave) . e_y <= gap = (x - phi(x)) . e_y,
//
// which is (2.49) with the slave on top. A curve is the nodes of its edges: the vertices in the
// order of strictly increasing abscissa, then, of degree 2, a point of each edge near its middle.
// By degree 1 the gap is that of the polygons. By degree 2 it is that of the parabolas through the
// three points of each edge, so that bodies with straight edges meet along their true curves if
// these points are on them; displacements are quadratic in the abscissa, with their third node in
// the middle of the straight edge. In every function of this file a curve of too few nodes, or of
// another order, throws bad_input, naming the curve and the node.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/scene.hpp"

#include <array>

namespace rbvi {

/// Where multipliers live.
enum class MultiplierSpace {
  macro_edges, ///< constant on macro-edges (local average contact, LAC): two slave edges, of
               ///< degree 2 one
  nodes        ///< continuous, linear on each slave edge
};

/// How the integrals over two meshes that do not match are taken.
enum class PairQuadrature {
  intersection, ///< exact: slave and master edges are intersected
  direct        ///< Gauss points of the slave edges alone
};

struct PairDiscretisation {
  MultiplierSpace multiplier = MultiplierSpace::macro_edges;
  PairQuadrature quadrature = PairQuadrature::intersection;
};

/// The constraint, weak and at vertices. Columns are the vertical displacements of the slave nodes,
/// then of the master nodes, each in the order of their curve; eta are the basis functions of the
/// multipliers. A slave point beyond the ends of the master curve has no partner and contributes
/// nothing.
struct PairOperators {
  SparseMatrix b; ///< multipliers x nodes: int (v_master o phi - v_slave) eta ds (2.51)
  Vector g;       ///< multipliers: int gap eta ds (2.52)
  Vector weights; ///< multipliers: int eta ds over the slave points that have a partner
  std::vector<Index> uncovered; ///< multipliers with a slave point that has none
  std::vector<Index> paired;    ///< slave vertices that have a partner, increasing
  SparseMatrix nodal_b;         ///< paired x nodes: the constraint at these vertices
  Vector nodal_gap;             ///< paired
};

/// Vertices of a curve by its number of nodes.
Index vertex_count(Index nodes, int degree);

/// Number of multipliers on a slave curve of so many nodes. A macro-edge has a node inside: of
/// degree 1 it is two edges, the last three if their number is odd; of degree 2 it is one edge.
Index multiplier_count(Index slave_nodes, MultiplierSpace space, int degree = 1);

/// The macro-edge that holds a slave edge.
Index macro_edge_of(Index edge, Index slave_nodes, int degree = 1);

/// Integrals are in arc length of the straight slave edges. O(slave + master nodes).
PairOperators couple(const std::vector<Point> &slave, const std::vector<Point> &master,
                     const PairDiscretisation &discretisation, int degree = 1);

/// Whether a multiplier has no partner somewhere: its weight, and `whole`, which it would have with
/// one everywhere.
bool is_partial(double weight, double whole);

/// The ends of contact where `lambda` is above `least`: where the slave curve ends, unless that end
/// is closed (the body ends, or is mirrored, there), or where nothing faces it from there on: the
/// last multiplier with a partner, and those before it that do not have one everywhere.
double ends_in_contact(const Vector &whole, const Vector &weights, const Vector &lambda,
                       double least, std::array<bool, 2> closed);

/// Gram matrix of the multipliers in L2 of the slave polygon; an entry (possibly zero) for every
/// pair of neighbours.
SparseMatrix multiplier_product(const std::vector<Point> &slave, MultiplierSpace space,
                                int degree = 1);

/// Where a multiplier is drawn: the middle of its macro-edge, by arc length, or its vertex.
std::vector<Point> multiplier_points(const std::vector<Point> &slave, MultiplierSpace space,
                                     int degree = 1);

} // namespace rbvi
