// The forces of contact added up on two roads, for each side of each interface, on the rigid
// motions of the plane (two translations, a turn about the origin of the mapped mesh): as outputs
// know them, by the normals and pressures at points, and as the solver does, lambda^T B on the
// motion.
//
// What a solver has solved balances loads and reactions with lambda^T B by construction (Galerkin:
// rigid motions of a body that nothing holds are in its space, and the residual says how well), and
// so this comparison is all that is left of a balance of the body. It sees a normal, a weight, a
// point or a side that one road has and the other has not. It does not see a normal that both ask
// the same wrong function for, nor a gap: they leave forces in balance.
#pragma once

#include "rbvi/contact/contact.hpp"

namespace rbvi {

/// Two forces and a moment.
using Resultant = std::array<double, 3>;

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
std::vector<TwoRoads> two_roads(const Scene &scene, const ContactInterface &interface,
                                const FullMu &mu, const ContactState &state, const Vector &lambda,
                                const Vector &solved = {});

/// Throws failure, naming contact and boundary, where the roads differ by more than `tolerance` of
/// the sizes. `b`: of the solver, all rows; null: evaluated anew.
void check_forces(const Scene &scene, const Contact &contact, const FullMu &mu,
                  const ContactState &state, const Vector &lambda, const SparseMatrix *b,
                  double tolerance = 1e-10);

} // namespace rbvi
