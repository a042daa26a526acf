// Two curves as they are now, and the points of the upper one with their partners on the lower one.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/functions.hpp"

#include <array>
#include <vector>

namespace rbvi {

/// A curve of edges of degree 1 or 2: its vertices in their order, then the middles of the edges.
class CurrentCurve {
public:
  CurrentCurve(std::vector<Point> nodes, int degree);

  Index edges() const { return edges_; }
  Index per_edge() const { return degree_ + 1; } ///< nodes
  Index node(Index edge, Index local) const { return local < 2 ? edge + local : edges_ + 1 + edge; }
  const Point &vertex(Index i) const { return nodes_[i]; }
  /// The nodal functions of an edge at 0 <= s <= 1, and their derivatives by s.
  std::array<double, 3> values(double s) const;
  std::array<double, 3> slopes(double s) const;
  Point at(Index edge, double s) const { return sum(edge, values(s)); }
  Point tangent(Index edge, double s) const { return sum(edge, slopes(s)); } ///< dy / ds

  /// Sum of nodal vectors (one for each node of the curve).
  Point sum(Index edge, const std::array<double, 3> &coefficients,
            const std::vector<Point> &of_nodes) const;

private:
  Point sum(Index edge, const std::array<double, 3> &coefficients) const {
    return sum(edge, coefficients, nodes_);
  }

  std::vector<Point> nodes_;
  Index degree_, edges_;
};

/// Which ends of a curve lie on an axis of symmetry, a vertical line: the mirrored edge takes part
/// in the normal there.
struct MirroredEnds {
  bool first = false, last = false;
};

/// Upwards, of length 1, at every node: at vertices the mean of both edges.
std::vector<Point> nodal_normals(const CurrentCurve &curve, MirroredEnds mirrored);

/// A point of the slave curve and its partner, by coordinates 0 to 1 along their edges.
struct Facing {
  Index slave_edge, master_edge;
  double s, t;
  double weight;    ///< share of the slave edge
  Point normal;     ///< nu; tau = (nu_y, -nu_x), in the direction of the master curve
  double stretch;   ///< |dy / dt| of the master curve
  double curvature; ///< k
};

class Projection {
public:
  /// Both must outlive it.
  Projection(const CurrentCurve &slave, const CurrentCurve &master, MirroredEnds mirrored);

  /// Four Gauss points on each piece of the slave curve that faces one master edge. Throws failure
  /// where a point has no projection.
  std::vector<Facing> gauss_points() const;
  /// The slave vertices that have a partner; weight: their number.
  std::vector<Facing> vertices() const;
  /// The slave edge that each master vertex faces, as ContactOperators::segments.
  std::vector<Index> segments() const;

private:
  Facing facing(Index slave_edge, double s, Index master_edge) const;
  double abscissa_of(Index master_vertex, Index &from) const;

  const CurrentCurve &slave_, &master_;
  std::vector<Point> normals_;
  /// Where each master vertex is on the slave curve: edge + s; beyond its ends -1 and edges + 1.
  std::vector<double> cuts_;
};

} // namespace rbvi
