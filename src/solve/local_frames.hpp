// Displacements of the nodes of the contact curve by their components along the normal and the
// tangent, u = Q v, so that a bound on the normal displacement is a bound on a single unknown.
#pragma once

#include "rbvi/fem/contact_layer.hpp"
#include "rbvi/problem/problem.hpp"

namespace rbvi {

class LocalFrames {
public:
  /// Collective. `rows`: global row of each dof of the layer. `problem` must outlive it.
  LocalFrames(const Problem &problem, const ContactLayer &layer, const std::vector<PetscInt> &rows);
  /// The mu of what follows. Collective.
  void set(const Mu &all_parameters);
  Handle<Mat> turned(Mat a) const;                  ///< Q^T A Q
  Handle<Vec> turned(Vec f) const;                  ///< Q^T f
  Handle<Vec> turned_back(Vec v) const;             ///< Q v
  void turn(std::vector<NitscheFace> &faces) const; ///< functionals of u become those of v
  /// v <= upper: the gap less the motion for normal components, else infinity.
  Handle<Vec> upper() const;

private:
  /// A node of the curve: its first row, its frame.
  struct Node {
    PetscInt row;
    Point reference, n;
    double gap;
  };
  const Problem &problem_;
  std::vector<Node> nodes_;
  std::vector<int> node_of_dof_; ///< of the layer, where it is the first of a node; else -1
  Handle<Mat> q_;
};

} // namespace rbvi
