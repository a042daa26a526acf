// The forces of contact added up on two roads, for each side of each interface, on the rigid
// motions of the plane (two translations, a turn about the origin of the mapped mesh) or of space,
// of a membrane on the constant: as outputs know them, by the normals and pressures at points, and
// as the solver does, lambda^T B, or Nitsche's terms, on the motion. Of a body that is turned about
// x = 0 Nitsche's terms know of no motion but that along the axis.
//
// It sees a normal, a weight, a point or a side that one road has and the other has not. It does
// not see a gap, which leaves forces in balance, nor a normal that both ask the same wrong function
// for: a normal of the body is compared with that of its edges (check_body_normal). With loads,
// reactions and springs: fem/body_balance.hpp.
#pragma once

#include "rbvi/contact/contact.hpp"
#include "rbvi/contact/nitsche_curve.hpp"

namespace rbvi {

/// The forces along the axes, then the moments about them.
using Resultant = std::array<double, 6>;

/// Of some forces, by outputs and by lambda^T B, and the sum of the sizes of all their terms.
struct TwoRoads {
  Resultant by_points{}, by_nodes{}, sizes{};
  void add_point(const Point &at, const Point &force);
  /// `force`: of B^T lambda, which is that of the body on its partner.
  void add_node(const Point &at, const Point &force);
  /// The largest difference over the sizes; not finite where a force is not.
  double difference() const;
};

/// Of each side of an interface; none where outputs are no sums over points. `solved`: B^T lambda
/// at the columns as the solver has it; empty: B evaluated anew.
std::vector<TwoRoads> two_roads(const Scene &scene, ContactInterface &interface, const FullMu &mu,
                                const ContactState &state, const Vector &lambda,
                                const Vector &solved = {});
/// By Nitsche's method, of all curves: the forces of the points of `faces`, which are those of all
/// cells of the layer at its state, and what its terms test rigid motions with.
TwoRoads two_roads(const NitscheLayer &layer, const FullMu &mu,
                   const std::vector<NitscheFace> &faces, const Matrix &pressures,
                   const Vector &bounds);

/// Throws failure, naming contact and boundary, where the roads differ by more than `tolerance` of
/// the sizes. `b`: of the solver, all rows; null: evaluated anew.
void check_forces(const Scene &scene, const Contact &contact, const FullMu &mu,
                  const ContactState &state, const Vector &lambda, const SparseMatrix *b,
                  double tolerance = 1e-10);
/// The same by Nitsche's method, at a displacement of the layer.
void check_forces(const NitscheLayer &layer, const FullMu &mu, const Vector &u,
                  double tolerance = 1e-10);

} // namespace rbvi
