// The parametrised problem on one communicator: scene + mesh + operators at one mu,
//
//   A u + B^T lambda = F,    B u <= G,    lambda >= 0,    lambda . (B u - G) = 0.
//
// A and F are distributed over the free dofs; B acts on the contact dofs alone (B u = B_c E^T u)
// and is replicated, as are G and lambda.
#pragma once

#include "rbvi/fem/assembly.hpp"
#include "rbvi/fem/contact_region.hpp"

#include <optional>

namespace rbvi {

/// Valid until the problem is assembled at another mu.
struct Operators {
  Mu mu; ///< all parameters
  Mat a = nullptr;
  Vec f = nullptr; ///< zero where the scene has no load
  SparseMatrix b;  ///< dual x contact dofs
  Vector g;        ///< dual
  Vector weights;  ///< integral of each hat function over the mapped contact region
  Vector obstacle; ///< psi at the mapped nodes of the contact region
};

class Problem {
public:
  /// Collective on `comm`. Throws bad_input for a mesh that does not fit the scene.
  Problem(MPI_Comm comm, Scene scene, const MeshOptions &options);

  MPI_Comm comm() const { return mesh_.comm; }
  const Scene &scene() const { return scene_; }
  const Mesh &mesh() const { return mesh_; }
  const Dofs &dofs() const { return dofs_; }
  const ContactRegion &contact() const { return contact_; }
  const Trace &trace() const { return contact_.trace; }

  /// Collective. `mu`: the free parameters, inside or outside the box. Throws failure if a cell is
  /// inverted.
  const Operators &assemble(const Mu &mu);
  /// Not collective: the contact operators alone, B, G, weights and obstacle.
  void assemble_contact(const Mu &mu, Operators &operators);

  Mat v_product(); ///< Gram matrix of V, assembled at the first call. Collective.
  const SparseMatrix &w_product() const { return w_product_; } ///< dual x dual

private:
  Scene scene_;
  Mesh mesh_;
  Dofs dofs_;
  ContactRegion contact_;
  MappedCells cells_;
  Handle<Mat> a_, v_product_;
  Handle<Vec> f_;
  ContactMatrix b_;
  SparseMatrix w_product_;
  Operators operators_;
};

} // namespace rbvi
