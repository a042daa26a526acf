// The parametrised problem on one communicator: scene + mesh + operators at one mu,
//
//   A u + B^T lambda = F,    B u <= G,    lambda >= 0,    lambda . (B u - G) = 0.
//
// A and F are distributed over the free dofs; B acts on the contact dofs alone (B u = B_c E^T u)
// and is replicated, as are G and lambda. Where the scene has a motion, u is what is left beside it
// (w of Scene::motion) and G takes the motion in: it is rigid, so that it does no work in A.
//
// With friction lambda has a tangential part behind the normal one; there B u - G is the slip, and
// |lambda_tau| <= bound, lambda_tau = bound slip / |slip| where it slips (corrected (3.32)).
#pragma once

#include "rbvi/law/friction/friction.hpp"

#include "rbvi/problem/summed.hpp"

#include "rbvi/fem/contact_curves.hpp"
#include "rbvi/fem/contact_region.hpp"
#include "rbvi/fem/contact_support.hpp"

#include <optional>

namespace rbvi {

/// Valid until the problem is assembled at another mu.
struct Operators {
  FullMu mu;
  Mat a = nullptr;
  Vec f = nullptr;  ///< zero where the scene has no load
  SparseMatrix b;   ///< dual x contact dofs
  Vector g;         ///< dual
  Vector weights;   ///< integral of each normal multiplier's basis function over the mapped surface
  Index normal = 0; ///< normal multipliers: the first of the dual dofs
  FrictionBound bound;  ///< of the others
  SparseMatrix nodal_b; ///< the constraint at single nodes, nodal_b u <= nodal_gap
  Vector nodal_gap;
};

class Problem {
public:
  /// Collective on `comm`. Throws bad_input for a mesh that does not fit the scene.
  Problem(MPI_Comm comm, Scene scene, const MeshOptions &options);

  MPI_Comm comm() const { return mesh_.comm; }
  const Scene &scene() const { return scene_; }
  const Mesh &mesh() const { return mesh_; }
  const Dofs &dofs() const { return dofs_; }
  bool two_bodies() const { return curves_.has_value(); }
  bool on_support() const { return support_.has_value(); }
  /// Contact by Nitsche's method: no B, G, weights and nodal constraint are assembled.
  bool nitsche() const { return scene_.nitsche.has_value(); }
  const ContactRegion &contact() const { return contact_.value(); }  ///< an obstacle
  const ContactCurves &curves() const { return curves_.value(); }    ///< two bodies
  const ContactSupport &support() const { return support_.value(); } ///< a rigid support
  const Trace &trace() const;
  Index dual_size() const { return w_product_.rows(); }

  /// Collective. `mu`: the free parameters, inside or outside the box. A and F are assembled again
  /// only where the parameters that they depend on have changed. Throws failure if a cell is
  /// inverted, bad_input for a coefficient that is not finite.
  const Operators &assemble(const Mu &mu);
  /// Not collective: the contact operators alone, B, G, weights and the nodal constraint.
  void assemble_contact(const Mu &mu, Operators &operators);

  /// A and F of the last mu term by term.
  const Summed<Mat> &a_terms() const { return a_; }
  const Summed<Vec> &f_terms() const { return f_; }

  Mat v_product(); ///< Gram matrix of V, assembled at the first call. Collective.
  const SparseMatrix &w_product() const { return w_product_; } ///< dual x dual

private:
  void assemble_obstacle(Operators &operators);
  void assemble_pair(Operators &operators);
  void assemble_support(Operators &operators);

  Scene scene_;
  Mesh mesh_;
  Dofs dofs_;
  std::optional<ContactRegion> contact_;
  std::optional<ContactCurves> curves_;
  std::optional<ContactSupport> support_;
  MappedCells cells_;
  Summed<Mat> a_;
  Summed<Vec> f_;
  Handle<Mat> v_product_;
  std::optional<ContactMatrix> b_; ///< an obstacle
  SparseMatrix w_product_;
  Operators operators_;
};

} // namespace rbvi
