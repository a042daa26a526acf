// Points of the slave curve and their partners on the master curve. The search is the same however
// a point is projected: the projection says where the vertices of the master curve are along the
// slave curve, which cuts it into pieces that each face one master edge, and then the partner of a
// point on the master edge that it faces.
#pragma once

#include "rbvi/contact/curve.hpp"
#include "rbvi/element/quadrature.hpp"

#include <span>

namespace rbvi {

struct PairPoint {
  int slave_edge, master_edge;
  double s, t = 0;   ///< of the point and of its partner, 0 to 1 along their edges
  double weight = 0; ///< share of the slave edge; then of the integral over it, undeformed
  double gap = 0;    ///< along the normal, without displacements
  Point normal{};    ///< of length 1, towards the slave; tau = (n_y, -n_x)
};

/// Of the master curve at a partner: |dy / dt|, and k of its field of normals n, tau' = k n.
struct Bend {
  double stretch, curvature;
};

/// A place on a curve; -1 and edges + 1: beyond its ends.
struct CurvePlace {
  int edge;
  double s = 0;
  double minus(const CurvePlace &other) const { // in edges
    return edge - other.edge + s - other.s;
  }
};

/// Where the vertices of the master curve are along a slave curve, in their order.
struct Cuts {
  std::vector<CurvePlace> places{};
  int slave_edges = 0;

  /// The points of a rule on each piece, by increasing place, with their shares of the slave edge.
  std::vector<PairPoint> on_pieces(std::span<const EdgePoint> rule) const;
  /// Those of some places, by increasing place, that face a master edge.
  std::vector<PairPoint> at(const std::vector<CurvePlace> &slave) const;
  std::vector<PairPoint> at_vertices() const;
  /// ContactOperators::segments.
  std::vector<Index> segments() const;
};

/// Two curves with what the search has found.
struct Partners {
  NodalCurve slave, master;                  ///< where they are
  std::vector<double> lengths{};             ///< of the straight slave edges, undeformed
  std::vector<std::array<double, 2>> hats{}; ///< hat_weights of them
  Cuts cuts{};
  std::vector<PairPoint> points{};   ///< of quadrature, with their weights
  std::vector<Bend> bends{};         ///< at their partners; empty where nothing asks for them
  std::vector<PairPoint> vertices{}; ///< those of the slave curve that have a partner
};

} // namespace rbvi
