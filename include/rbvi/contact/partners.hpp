// Points of the slave curve and their partners on the master curve, along a continuous field of
// normals of the master curve: that of averaged normals, which sharp corners and the ends of pieces
// interrupt, or e_y everywhere (vertical pairing). Where the normals of master vertices meet the
// slave curve they cut it into parts that each face one master edge. Pieces face each other where
// they run alike: then the normals of both bodies are opposed. Both curves may be in several
// pieces, open or closed.
#pragma once

#include "rbvi/contact/curve.hpp"
#include "rbvi/element/quadrature.hpp"

#include <span>

namespace rbvi {

struct PairPoint {
  int slave_edge, master_edge;
  double s, t = 0;   ///< of the point and of its partner, 0 to 1 along their edges
  double weight = 0; ///< share of the slave edge; then of the integral over the slave curve
  double gap = 0,
         slip = 0; ///< along the normal, and of the motion along tau, without displacements
  Point normal{};  ///< of length 1, towards the slave; tau = (n_y, -n_x)
};

/// Of the master curve at a partner: |dy / dt|, and k of its field of normals n, tau' = k n; not
/// found of vertical pairing.
struct Bend {
  double stretch, curvature;
};

/// A master edge with the part of the slave curve that faces it, and about where its partners are.
struct FacedPart {
  Index master_edge;
  CurvePlace begin, end;
  double t_begin = 0, t_end = 1;
  double t_at(const CurvePlace &place) const {
    return t_begin + place.minus(begin) / end.minus(begin) * (t_end - t_begin);
  }
};

/// A part of a slave edge that faces something, 0 <= begin < end <= 1.
struct FacedEdge {
  Index edge;
  double begin, end;
};

/// The edges of a piece between its sharp corners.
struct CurveSection {
  std::vector<Index> edges;
  bool loop = false;
};
/// `whole`: corners do not matter.
std::vector<CurveSection> sections_of(const NodalCurve &curve, bool whole);

/// Unit normals of a curve at the nodes of each edge, to the left of its direction: at a vertex
/// inside a section the mean of both edges. At the end of a section on an axis of symmetry
/// (`fixed`: bits of the components that are, per node) the mirrored edge takes part.
using EdgeNormals = std::vector<std::array<Point, 3>>;
EdgeNormals averaged_normals(const NodalCurve &curve, const std::vector<CurveSection> &sections,
                             const std::vector<int> &fixed);
EdgeNormals vertical_normals(const NodalCurve &curve);

/// What the search needs of a master curve.
struct MasterField {
  const std::vector<CurveSection> &sections;
  EdgeNormals normals;
  bool vertical = false; ///< e_y everywhere, and curves that are graphs as as_graph makes them
};

/// The search. Curves and sections must outlive it.
class PartnerSearch {
public:
  PartnerSearch(const NodalCurve &slave, const NodalCurve &master, MasterField field);

  /// The points of a rule on each part, by increasing slave edge, with their shares of it.
  std::vector<PairPoint> on_parts(std::span<const EdgePoint> rule) const;
  /// Those of the places that have a partner.
  std::vector<PairPoint> at(const std::vector<CurvePlace> &places) const;
  std::vector<PairPoint> at_vertices() const;
  /// Along the slave curve, of an edge as long as they can be.
  std::vector<FacedEdge> faced() const;
  /// Sets partner and normal of a point. Throws failure where it has no projection.
  Bend project(PairPoint &point) const;
  /// ContactOperators::segments.
  std::vector<Index> segments() const;

private:
  /// One piece of the slave with one section of the master.
  class Sweep;
  double beside(Index master_edge, Index end, const Point &x) const;
  bool alike(Index master_edge, Index end, Index slave_edge) const;
  void sort_parts();
  double gap_at(const FacedPart &part, const CurvePlace &place) const;

  const NodalCurve &slave_, &master_;
  MasterField field_;
  std::vector<FacedPart> parts_; ///< along the slave curve
};

/// Two curves with what the search has found.
struct Partners {
  NodalCurve slave, master; ///< where they are
  HatWeights hats{};        ///< of the straight slave edges, undeformed
  std::vector<Index> segments{};
  std::vector<PairPoint> points{};   ///< of quadrature, with their weights
  std::vector<Bend> bends{};         ///< at their partners
  std::vector<PairPoint> vertices{}; ///< those of the slave curve that have a partner
  std::vector<FacedEdge> faced{};
  std::vector<PairPoint> cuts{}; ///< where these begin and end inside of an edge
};

} // namespace rbvi
