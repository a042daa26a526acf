// Displacements of the nodes of a contact boundary by their components along the normal and the
// tangents, u = Q v, so that a bound on the normal displacement is a bound on a single unknown.
#pragma once

#include "rbvi/fem/problem.hpp"

namespace rbvi {

/// normal . u <= gap at one node.
struct NodalBound {
  std::vector<Index> contact_dofs; ///< of the components that nothing fixes
  Vector normal;                   ///< these components, of length 1
  double gap;
};

/// In the plane at all nodes, middles too, of the boundaries of interfaces of cells beside them,
/// but for those that are fixed in some direction. Throws bad_input for a node of two boundaries.
std::vector<NodalBound> bounds_along(const Contact &contact, const FullMu &mu);

class LocalFrames {
public:
  /// Collective.
  explicit LocalFrames(const Problem &problem);
  /// The bounds of what follows, always at the same nodes. Collective.
  void set(std::vector<NodalBound> bounds);
  Handle<Mat> turned(Mat a) const;      ///< Q^T A Q
  Handle<Vec> turned(Vec f) const;      ///< Q^T f
  Handle<Vec> turned_back(Vec v) const; ///< Q v
  const std::vector<NodalBound> &bounds() const { return bounds_; }
  /// v <= upper: the gap for normal components, else infinity.
  Handle<Vec> upper() const;

private:
  std::vector<NodalBound> bounds_;
  std::vector<PetscInt> row_of_; ///< contact dofs: row if it is this rank's, else -1
  Handle<Mat> q_;
};

} // namespace rbvi
