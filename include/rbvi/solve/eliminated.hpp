// Contact by active sets with the constrained displacements eliminated: no column of B A^-1 B^T is
// asked for. Each active constraint gives up one displacement dof of its node, its pivot; P are all
// of them, N the other contact dofs:
//
//   C u = c,  C = R^T B    ->    u = Z v + u_0,   Z = [I; -C_P^-1 C_N],   u_0 = C_P^-1 c on P
//   x = fixed + T y        ->    W^T A Z v = W^T (f - B^T fixed - A u_0),   W as Z, of T^T B
//
// C_P is sparse, close to a mass matrix of the active nodes. The equation is solved by conjugate
// gradients (GMRES where a slip under Coulomb's law makes it unsymmetric), preconditioned by a
// factorisation of A without the rows and columns of P, for two bodies of A with the slave's dofs
// in P tied to the master's at single nodes, or by algebraic multigrid for it where u is a scalar
// and there are many dofs, or where an option asks for it. It stays while the sets change by
// little. Where a constraint has no pivot or the iteration fails, the systems of that solve keep
// their multipliers and are solved by a sparse LU factorisation each.
//
// A rank has the multipliers, and the rows of B, of its dual nodes
// (fem/distributed_contact.hpp).
#pragma once

#include "rbvi/contact/pivots.hpp"
#include "rbvi/method/active_sets.hpp"
#include "rbvi/solve/methods.hpp"

namespace rbvi {

class Elimination;
struct OwnContact;

class Eliminated {
public:
  /// `problem` must outlive it. Options of the factorisation under -hf_, of the iteration under
  /// -hf_krylov_. Collective.
  explicit Eliminated(Problem &problem);

  /// `op`: this rank's rows at least; the rows of others are not looked at. `start`: as
  /// FrictionResult::start, of all multipliers, or empty. `accuracy`: of the systems, relative.
  /// `by_rule`: friction_answer. Throws failure, saying what to try, where one cannot be solved.
  /// Collective.
  MethodResult solve(const Operators &op, const Vector &start, double accuracy = 1e-13,
                     bool by_rule = false);

  int factorisations() const { return factorisations_; }
  int krylov_steps() const { return krylov_steps_; }

private:
  SetSolution solve_system(const Operators &op, const OwnContact &contact, const SetSystem &system,
                           double accuracy);
  Vector eliminate(const Operators &op, const Elimination &z, const Elimination *other,
                   const Vector &constraint, Vec force, double accuracy);
  void drop_pivots(Mat a, const Elimination &z);
  void tie_pivots(Mat a, const Elimination &z, const SparseMatrix &ties);
  void precondition(const Operators &op, const Elimination &z);
  bool on_any_rank(bool here) const;

  Problem &problem_;
  const DualLayout &layout_;
  ContactDofs dofs_;
  bool multigrid_; ///< in place of a factorisation
  Handle<KSP> factor_;
  Handle<Mat> reduced_;              ///< what is factorised
  Handle<MatNullSpace> rigid_modes_; ///< of vectors by multigrid
  std::vector<PetscInt> factored_;   ///< its pivots, of this rank
  bool of_another_a_ = true;         ///< or of none
  bool tied_ = false;                ///< with pivots tied to other dofs
  int factorisations_ = 0, krylov_steps_ = 0;
  Handle<Vec> u_;         ///< of the last system
  double reaction_ = 0;   ///< |B^T x| there
  std::string complaint_; ///< why systems of this solve are not eliminated
};

/// Eliminated on a mesh and on those that it was refined from. From the sets of the coarser mesh
/// the finer one takes a few steps; from none as many as layers of cells between them and the
/// answer.
class GridSequence {
public:
  /// `problem` must outlive it. Collective.
  explicit GridSequence(Problem &problem) : problem_(problem), on_this_(problem) {}
  /// `op`: of the problem at mu. `start`: as above; where it is empty, or the mesh is fine, from
  /// the coarser meshes, where there are any, first to a lower `accuracy`. Friction is solved by
  /// its rule on the coarsest mesh that is used, and continued on the others; not `by_rule`: it is
  /// continued from `start` on this mesh. Collective.
  MethodResult solve(const Mu &mu, const Operators &op, const Vector &start,
                     double accuracy = 1e-13, bool by_rule = true);

private:
  bool has_coarser();

  Problem &problem_;
  Eliminated on_this_;
  std::unique_ptr<Problem> coarser_problem_;
  std::unique_ptr<GridSequence> coarser_; ///< made when first wanted
  SparseMatrix from_coarser_;             ///< of multipliers
};

} // namespace rbvi
