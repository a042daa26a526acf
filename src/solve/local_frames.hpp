// Displacements of the nodes of the contact curve by their components along the normal and the
// tangent, u = Q v, so that a bound on the normal displacement is a bound on a single unknown.
#pragma once

#include "rbvi/fem/contact_layer.hpp"
#include "rbvi/problem/problem.hpp"

namespace rbvi {

/// The node of the curve that each dof of the layer is the first of; -1: none.
std::vector<int> nodes_of_dofs(const ContactSupport &support, const ContactLayer &layer);

class LocalFrames {
public:
  /// Collective. At the first `nodes` nodes of the support's curve, vertices before middles.
  /// `problem` must outlive it.
  LocalFrames(const Problem &problem, std::size_t nodes);
  /// The mu of what follows. Collective.
  void set(const FullMu &all_parameters);
  Handle<Mat> turned(Mat a) const;      ///< Q^T A Q
  Handle<Vec> turned(Vec f) const;      ///< Q^T f
  Handle<Vec> turned_back(Vec v) const; ///< Q v
  /// Functionals of u become those of v.
  void turn(std::vector<NitscheFace> &faces, const std::vector<int> &node_of_dof) const;
  /// v <= upper: the gap less the motion for normal components, else infinity.
  Handle<Vec> upper() const;

private:
  /// A node of the curve: its first row if it is this rank's, else -1; its frame.
  struct Node {
    PetscInt row;
    Point reference, n;
    double gap;
  };
  const Problem &problem_;
  std::vector<Node> nodes_;
  Handle<Mat> q_;
};

} // namespace rbvi
