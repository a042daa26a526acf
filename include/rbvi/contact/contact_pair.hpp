// The operators of two curves in 2D that are in contact, from points of the slave (upper) curve and
// their partners on the master (lower) one; and vertical pairing, where the partner of a point x is
// the point phi(x) of the master curve with the same abscissa. The displacements of both satisfy
//
//   (u_master o phi - u_slave) . e_y <= gap = (x - phi(x)) . e_y,
//
// which is (2.49) with the slave on top. A curve is the nodes of its edges: the vertices in the
// order of strictly increasing abscissa, then, of degree 2, a point of each edge near its middle.
// By degree 1 the gap is that of the polygons. By degree 2 it is that of the parabolas through the
// three points of each edge, so that bodies with straight edges meet along their true curves if
// these points are on them; displacements are quadratic in the abscissa, with their third node in
// the middle of the straight edge. A curve of too few nodes, or of another order, is bad_input that
// names the curve and the node.
#pragma once

#include "rbvi/contact/interface.hpp"
#include "rbvi/contact/partners.hpp"

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

/// The constraint, weak (2.51), (2.52) and at slave vertices. eta are the basis functions of the
/// multipliers, `weights` their integrals over the slave points that have a partner. A slave point
/// beyond the ends of the master curve has none and contributes nothing.
struct PairOperators : ContactOperators {
  std::vector<Index> paired{};  ///< slave vertices that have a partner, increasing: rows of nodal_b
  std::vector<Point> normals{}; ///< of these, out of the slave body
};

/// Rows of differences over both curves, one after the other. The points of a row are on few edges
/// of each.
class DifferenceRows {
public:
  /// `dofs`: of each node of the slave and then of the master curve the columns of its components,
  /// both or the vertical one alone; -1: none.
  DifferenceRows(const Partners &of, const std::vector<int> &dofs, Index columns);
  /// Adds factor * normal . (v(partner) - v(point)) to the row.
  void add(const PairPoint &point, double factor);
  void end_row();
  /// Of all rows; zeros are left out.
  SparseMatrix matrix() const;

private:
  /// Of the row: the edges that it has of a curve.
  struct Side {
    const NodalCurve &curve;
    Index first_node; ///< of the curve, among those of both
    Index first = 0, last = -1;
  };
  void add(Side &side, Index edge, double s, const Point &vector);
  void end_nodes(Index begin, Index end);

  const std::vector<int> &dofs_;
  Index size_; ///< columns
  Index components_;
  Side slave_, master_;
  std::vector<double> row_; ///< by node * components + component
  std::vector<int> columns_, begins_{0};
  std::vector<double> values_;
  bool sorted_ = true; ///< the columns of each row
};

PairOperators pair_operators(const Partners &partners, MultiplierSpace space,
                             const std::vector<int> &dofs, Index columns);

/// Vertical pairing.
Partners vertical_partners(std::vector<Point> slave, std::vector<Point> master,
                           PairQuadrature quadrature, int degree, bool axisymmetric = false);

/// Vertices of a curve by its number of nodes.
Index vertex_count(Index nodes, int degree);

/// Number of multipliers on a slave curve of so many nodes. A macro-edge has a node inside: of
/// degree 1 it is two edges, the last three if their number is odd; of degree 2 it is one edge.
Index multiplier_count(Index slave_nodes, MultiplierSpace space, int degree = 1);

/// The macro-edge that holds a slave edge.
Index macro_edge_of(Index edge, Index slave_nodes, int degree = 1);

/// The integral of each multiplier's function over the whole slave curve, from those of the hats
/// of its edges.
Vector whole_weights(const std::vector<std::array<double, 2>> &hats, MultiplierSpace space,
                     int degree);

/// Whether a multiplier has no partner somewhere: its weight, and `whole`, which it would have with
/// one everywhere.
bool is_partial(double weight, double whole);

/// Ends of the slave and of the master curve where the body ends (InterfaceMesh::closed).
struct ClosedEnds {
  std::array<bool, 2> slave, master;
};

/// The ends of contact where `lambda` is above `least`: where the slave curve ends, or where the
/// master curve does and nothing faces the slave from there on (the last multiplier with a partner,
/// and those before it that do not have one everywhere), unless that end is closed.
double ends_in_contact(const Vector &whole, const Vector &weights, const Vector &lambda,
                       double least, const ClosedEnds &closed);

/// Gram matrix of the multipliers in L2 of the slave polygon (see linear_gram); an entry (possibly
/// zero) for every pair of neighbours.
SparseMatrix multiplier_product(const std::vector<Point> &slave, MultiplierSpace space,
                                int degree = 1, bool axisymmetric = false);

/// Where a multiplier is drawn: the middle of its macro-edge, by arc length, or its vertex.
std::vector<Point> multiplier_points(const std::vector<Point> &slave, MultiplierSpace space,
                                     int degree = 1);

} // namespace rbvi
