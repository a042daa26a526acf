// The parametrised problem on one communicator: scene + mesh + operators at one mu,
//
//   A u + B^T lambda = F,    B u <= G,    lambda >= 0,    lambda . (B u - G) = 0.
//
// A and F are distributed over the free dofs; B acts on the contact dofs alone (B u = B_c E^T u).
// B_c, G and the weights are on every rank, or this rank's rows of them alone (ContactRows), which
// fem/distributed_contact.hpp makes a PETSc matrix and vectors of. Where the scene has a
// motion, u is what is left beside it (w of Scene::motion) and G takes the motion in: it is rigid,
// so that it does no work in A. Where boundaries impose values l(mu), u is zero there as well, F is
// f(v) - a(l, v) and G takes B l in.
//
// With friction lambda has a tangential part behind the normal one; there B u - G is the slip, and
// |lambda_tau| <= bound, lambda_tau = bound slip / |slip| where it slips (corrected (3.32)).
// Niakh (2022): (1.18), (1.19), (3.25)-(3.31).
#pragma once

#include "rbvi/contact/named_outputs.hpp"
#include "rbvi/element/output_cells.hpp"
#include "rbvi/fem/distributed_contact.hpp"
#include "rbvi/fem/dofs.hpp"
#include "rbvi/fem/free_motions.hpp"
#include "rbvi/fem/imposed.hpp"
#include "rbvi/fem/summed.hpp"

#include <memory>
#include <optional>

namespace rbvi {

/// Valid until the problem is assembled at another mu. b, g, weights and the nodal constraint are
/// those of all interfaces together; empty by Nitsche's method.
struct Operators : ContactOperators {
  FullMu mu;
  Mat a = nullptr;
  Vec f = nullptr;           ///< zero where the scene has no load
  double imposed_energy = 0; ///< of the imposed values: that of u + l is this and that of u under F
  NodeLaws laws;             ///< of the multipliers
};

/// Where contact operators are evaluated.
struct ContactPoint {
  Mu mu;
  ContactState state{}; ///< where contact follows it
};

/// Without states.
std::vector<ContactPoint> at_rest(const std::vector<Mu> &set);

/// Which rows of B, G and the weights a solver wants on a rank.
enum class ContactRows {
  all,
  own ///< those of DualLayout::rows at least; what is left out is zero
};

/// Interfaces of at most so many multipliers are evaluated whole by every rank, without
/// communication. Of larger ones each rank evaluates its own rows; who wants all of them gets them
/// by one exchange. The answers are the same. (10 000 multipliers of a membrane take 1.3 ms, and
/// 0.6 ms to exchange.)
constexpr Index default_contact_gather = 10000;

class Problem {
public:
  /// Collective on `comm`. Throws bad_input (check_functions), for a mesh that does not fit, for
  /// boundaries that impose different displacements where they meet, and for motions of a body that
  /// neither displacements nor terms of a nor any contact can prevent.
  Problem(MPI_Comm comm, Scene scene, const MeshOptions &options,
          Index contact_gather = default_contact_gather);
  /// The same on the mesh with `levels` refinements less; null where there is none. Collective.
  std::unique_ptr<Problem> coarser(int levels = 1) const;
  int refinements() const { return mesh_options_.refine; }

  MPI_Comm comm() const { return mesh_.comm; }
  /// With the loads of the imposed values in f, and the springs of free bodies in a.
  const Scene &scene() const { return *scene_; }
  const Mesh &mesh() const { return mesh_; }
  const Dofs &dofs() const { return dofs_; }
  const InterfacePlaces &places() const { return places_; }
  const Contact &contact() const { return contact_; }
  const Trace &trace() const { return places_.trace; }
  const OutputCells &output_cells() const { return output_cells_; }
  const ContactShares &contact_shares() const { return contact_shares_; }
  Index dual_size() const { return contact_.dual_size(); }

  /// Collective. `mu`: the free parameters, inside or outside the box. A and F are assembled again
  /// only where the parameters that they depend on have changed. Throws failure if a cell is
  /// inverted, bad_input for a coefficient that is not finite, and for imposed displacements that
  /// are not or contradict each other. `slip`: the history of friction (contact/history.hpp).
  const Operators &assemble(const Mu &mu, ContactRows rows = ContactRows::all,
                            const Vector &slip = {});
  /// Not collective: the contact operators alone, all rows of B, G, weights and the nodal
  /// constraint.
  void assemble_contact(const Mu &mu, Operators &operators, const ContactState &state = {});
  /// Whose the multipliers are. Collective at the first call.
  const DualLayout &dual_layout();

  /// The imposed displacement l(mu) at all dofs in natural order, on every rank; zero where the
  /// scene imposes none. Collective.
  Vector imposed_displacement(const Mu &mu) const;
  const ImposedEnergy &imposed_energy() const { return imposed_energy_; }

  const std::vector<FreeBody> &free_bodies() const { return free_; }
  /// What the springs of free bodies are relaxed at, motions_of(free_bodies()) entries, in F from
  /// now on. Collective.
  void relax_springs(const Vector &beta);
  double spring_energy() const; ///< of springs that are relaxed at beta in the energy of A and F
  /// What each multiplier does to the free motions: B Z, rows of B x motions_of(free_bodies()), all
  /// rows on every rank. `operators`: with all rows. Collective.
  Matrix held_by(const Operators &operators) const;
  /// Z^T F without the springs, and the sum of the sizes of its terms. Collective.
  std::array<Vector, 2> pushed(const FullMu &mu) const;

  /// A and F of the last mu term by term.
  const Summed<Mat> &a_terms() const { return a_; }
  const Summed<Vec> &f_terms() const { return f_; }

  Mat v_product(); ///< Gram matrix of V, assembled at the first call. Collective.
  const SparseMatrix &w_product() const { return contact_.w_product(); } ///< dual x dual

private:
  bool is_split(std::size_t interface) const;
  void stiffen_springs();
  void assemble_split(ContactRows rows, const Vector &slip);

  Scene given_; ///< without the loads of imposed values
  MeshOptions mesh_options_;
  std::unique_ptr<Scene> scene_; ///< the interfaces refer to it
  Mesh mesh_;
  Dofs dofs_;
  std::vector<FreeBody> free_;
  InterfacePlaces places_;
  Contact contact_;
  OutputCells output_cells_;
  ContactShares contact_shares_; ///< of reactions
  Index contact_gather_;
  std::optional<DualLayout> dual_layout_;
  MappedVertices mapped_;
  Summed<Mat> a_;
  Summed<Vec> f_;
  Vector beta_;         ///< relax_springs()
  Handle<Vec> pressed_; ///< F with it
  ImposedEnergy imposed_energy_;
  Handle<Mat> v_product_;
  Operators operators_;
};

/// Outputs::strained of an answer whose u is at all dofs in natural order: by the gradient at the
/// middle of each cell. Collective.
double strained_share(const Problem &problem, const FullMu &mu, const Vector &u);

/// Sets Outputs::named and gap_error of an answer whose u is at all dofs in natural order. Not
/// collective.
void add_named_outputs(const Problem &problem, const FullMu &mu, const Vector &u,
                       const Vector &lambda, Outputs &outputs);

/// The same on every rank for any number of ranks. Throws bad_input for a point outside of the
/// mesh, for a reaction of a boundary where nothing is fixed in its direction, or that shares nodes
/// with a contact or a spring, whose forces on them are not known apart. Collective.
OutputCells cells_of_outputs(const Scene &scene, const Mesh &mesh, const Dofs &dofs);

} // namespace rbvi
