// The operators of two curves in 2D that are in contact, from points of the slave curve and their
// partners on the master curve. With x the point, xi its partner, n the normal out of the slave
// and tau = (-n_y, n_x) the displacements satisfy
//
//   n . (v(x) - v(xi)) <= gap,   and, with friction, tau . (v(x) - v(xi)) is the slip.
//
// Vertical pairing is (2.49), with the slave on top and n = -e_y: the partner has the same
// abscissa. By degree 1 the gap is that of the polygons. By degree 2 it is that of the curves
// through the three nodes of each edge, so that bodies with straight edges meet along their true
// curves if the middles are on them; of vertical pairing these are parabolas over the abscissa.
// Niakh (2022): (2.50).
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

/// Where the partner of a point is.
enum class PairProjection {
  normal,  ///< along the averaged normals of the master curve
  vertical ///< above or below; of small deformations alone, both curves graphs over x
};

struct PairDiscretisation {
  MultiplierSpace multiplier = MultiplierSpace::macro_edges;
  PairQuadrature quadrature = PairQuadrature::intersection;
  PairProjection projection = PairProjection::normal;
};

/// The multipliers' functions on a slave curve.
class PairMultipliers {
public:
  /// A macro-edge has a node inside and is of one piece: of degree 1 it is two edges, the last one
  /// of a piece three if their number is odd; of degree 2 it is one edge.
  PairMultipliers(const CurveShape &slave, MultiplierSpace space, int degree);

  Index count() const { return std::ssize(edges_); }
  MultiplierSpace space() const { return space_; }
  /// On which a function does not vanish, increasing.
  const std::vector<Index> &edges_of(Index multiplier) const { return edges_[multiplier]; }
  /// Of an edge: of its macro-edge, or of its vertices.
  const std::array<Index, 2> &on_edge(Index edge) const { return on_edge_[edge]; }
  double value(Index multiplier, Index edge, double s) const {
    if (space_ == MultiplierSpace::macro_edges) return 1;
    return on_edge_[edge][0] == multiplier ? 1 - s : s;
  }
  /// Their sum with coefficients.
  double sum(const Vector &lambda, Index edge, double s) const {
    const auto [a, b] = on_edge_[edge];
    return space_ == MultiplierSpace::macro_edges ? lambda[a] : (1 - s) * lambda[a] + s * lambda[b];
  }
  /// The integral of each over the whole slave curve, from those of the hats of its edges.
  Vector whole_weights(const HatWeights &hats) const;
  /// Gram matrix in L2 of the polygon (linear_gram), `copies` blocks; an entry (possibly zero) for
  /// every pair of neighbours.
  SparseMatrix gram(const NodalCurve &slave, int copies, bool axisymmetric = false) const;
  /// Where each is drawn: the middle of its macro-edge, by arc length, or its vertex.
  std::vector<Point> points(const NodalCurve &slave) const;

private:
  MultiplierSpace space_;
  std::vector<std::vector<Index>> edges_;
  std::vector<std::array<Index, 2>> on_edge_;
};

/// The constraint, weak (2.51), (2.52) and at slave vertices. eta are the basis functions of the
/// multipliers, `weights` their integrals over the slave points that have a partner. A slave point
/// beyond the ends of the master curve has none and contributes nothing.
struct PairOperators : ContactOperators {
  std::vector<Index> paired{}; ///< slave vertices that have a partner, increasing: rows of nodal_b
};

/// Rows of differences over both curves, one after the other. The points of a row are on few edges
/// of each.
class DifferenceRows {
public:
  /// `dofs`: of each node of the slave and then of the master curve the columns of its components;
  /// -1: none.
  DifferenceRows(const Partners &of, const std::vector<int> &dofs, Index columns);
  /// Adds factor * normal . (v(partner) - v(point)) to the row.
  void add(const PairPoint &point, double factor);
  void end_row();
  /// Of all rows; zeros are left out.
  SparseMatrix matrix() const;

private:
  /// Of the row: the vertices and the edges that it has of a curve.
  struct Side {
    const NodalCurve &curve;
    Index first_node; ///< of the curve, among those of both
    Index first_vertex = 0, last_vertex = -1, first_edge = 0, last_edge = -1;
  };
  void add(Side &side, Index edge, double s, const Point &vector);
  void end_nodes(Index first, Index last);

  const std::vector<int> &dofs_;
  Index size_; ///< columns
  Side slave_, master_;
  std::vector<double> row_; ///< by node * 2 + component
  std::vector<int> columns_, begins_{0};
  std::vector<double> values_;
  bool sorted_ = true; ///< the columns of each row
};

/// Those of the normal multipliers, then with friction of the tangential ones.
PairOperators pair_operators(const Partners &partners, const PairMultipliers &multipliers,
                             const std::vector<int> &dofs, Index columns, bool friction);

/// The integral of the magnitude of the tangential stress of these multipliers over what faces
/// something.
double tangential_force(const Partners &partners, const PairMultipliers &multipliers,
                        const Vector &shear);

/// The slave curve as lines, cut where it begins and ends to face something.
struct SlaveLines {
  std::vector<CurvePlace> places;
  std::vector<const PairPoint *> partners; ///< of the places; null: the end of lines without any
  std::vector<int> cells;                  ///< two places each
  std::vector<FacedEdge> parts;            ///< that the cells are
  std::vector<bool> faced;                 ///< of the cells
};
/// `whole`: the lines that face nothing, too. `partners` must outlive them.
SlaveLines slave_lines(const Partners &partners, bool whole);
std::vector<CurvePlace> middles_of(const SlaveLines &lines);
/// A field at the middles of lines: of the parabolas between its values at the places those that
/// fit its values at the points of quadrature best.
Vector fitted_middles(const Partners &partners, const SlaveLines &lines, const Vector &at_places,
                      const std::function<double(const PairPoint &)> &value);

/// B^T lambda at all nodes of the slave, then of the master, node * 2 + component. `lambda`: with
/// friction those of both laws.
Vector nodal_forces(const Partners &partners, const PairMultipliers &multipliers,
                    const Vector &lambda);
/// What the slave (part 0) and the master (part 1) are pushed with at each point.
PointForces point_forces(const Partners &partners, const PairMultipliers &multipliers,
                         const Vector &lambda);

/// Finds the partners of two curves: along the field of normals, or vertically, then the curves
/// must be graphs (as_graph). Gaps are those of the curves. `hats`: of the slave edges, that the
/// integrals are over.
Partners find_partners(NodalCurve slave, NodalCurve master, const PairDiscretisation &how,
                       MasterField field, const HatWeights &hats);

/// The gaps between other places of both curves.
void set_gaps(const NodalCurve &slave, const NodalCurve &master, std::vector<PairPoint> &points);

/// A curve with the middles of its edges (degree 2) moved along the parabola over x through the
/// three nodes of each to the middle of its abscissae. Throws bad_input, naming the curve and the
/// node, where x does not increase.
NodalCurve as_graph(NodalCurve curve, const std::string &name);

/// Whether a multiplier has no partner somewhere: its weight, and `whole`, which it would have with
/// one everywhere.
bool is_partial(double weight, double whole);

/// The ends of contact where `lambda` is above `least`: where a piece of the slave curve ends, or
/// where the master curve does and nothing faces the slave from there on (the last multiplier with
/// a partner, and those before it that do not have one everywhere), unless that end is closed.
/// `shares`: of the weights of multipliers, of what they would be with partners everywhere.
/// `closed`: of each piece of the slave curve, then whether all first and all last ends of the
/// master curve are.
double ends_in_contact(const PairMultipliers &multipliers, const CurveShape &slave,
                       const Vector &shares, const Vector &lambda, double least,
                       const std::vector<std::array<bool, 2>> &closed);

} // namespace rbvi
