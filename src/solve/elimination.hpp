// Active constraints C u = c over the ranks, each of which gives up a displacement dof, its pivot:
//
//   u_P = C_P^-1 (c - C_N u_N),
//
// on triangles of degree 2 with what its vertex moves (ContactDofs::moves), T^T u_P: C_P = C T^T.
// A rank has the constraints of its dual nodes. Where those of two ranks share no pivot, as by
// vertex quadrature, each rank factorises its block of C_P; elsewhere every rank factorises C_P
// whole, which is as large as the active sets.
#pragma once

#include "rbvi/contact/pivots.hpp"
#include "rbvi/core/dense.hpp"
#include "rbvi/fem/distributed_contact.hpp"
#include "rbvi/par/petsc.hpp"

namespace rbvi {

class Elimination {
public:
  /// `c`: this rank's constraints x contact dofs; `pivots`: a contact dof for each of them;
  /// `moves`: as ContactDofs. Throws
  /// failure where C_P is singular. Collective.
  Elimination(const DualLayout &layout, const SparseMatrix &c, const std::vector<Index> &pivots,
              const SparseMatrix &moves);

  Index count() const { return count_; } ///< of constraints, over all ranks
  /// The free displacement dofs of this rank's pivots.
  const std::vector<PetscInt> &pivots() const { return pivots_; }

  /// u at this rank's pivots, and back. Collective.
  Vector at_pivots(Vec u) const;
  void set_pivots(const Vector &values, Vec u) const;

  /// Adds T^T C_P^-1 (right - C_N u_N) to u_N; `right`: of this rank's constraints. Collective.
  void extend(const Vector &right, Vec u) const;
  /// r - C^T C_P^-T T r, zero at the pivots. Collective.
  void reduce(Vec r) const;
  /// C_P^-T T r of this rank's constraints. Collective.
  Vector multipliers(Vec r) const;
  /// PivotBlock::ties of this rank's constraints.
  SparseMatrix ties() const;

private:
  bool is_separate(const DualLayout &layout, const SparseMatrix &moved,
                   const std::vector<Index> &pivots) const;
  template <class Solve> Vector solved(const Vector &own, Solve &&solve) const;

  MPI_Comm comm_;
  Index contact_dofs_;
  Index first_ = 0, count_ = 0; ///< of this rank's constraints among all
  Handle<Mat> c_, t_;           ///< t_: T
  std::vector<PetscInt> pivots_;
  Handle<Vec> values_; ///< of the constraints
  Handle<VecScatter> to_pivots_;
  bool separate_ = true; ///< block_ is of this rank's constraints, else of all
  PivotBlock block_;
};

/// The equation of the displacement without the dofs that active constraints gave up
/// (solve/eliminated.hpp), W^T A Z, with a preconditioner for it. What it refers to must outlive
/// it.
struct ReducedSystem {
  Mat a;
  const Elimination &z; ///< of the displacement by the constraints
  const Elimination &w; ///< of the forces by the multipliers
  KSP factor;           ///< preconditioner of A, or of A without the pivots
  Vec scratch;          ///< a displacement

  /// v + what the constraints without right-hand side say of the pivots, where v is zero.
  void extend(Vec v) const;
  /// W^T r, zero at the pivots.
  void reduce(Vec r) const;
  void zero_pivots(Vec v) const { z.set_pivots(Vector::Zero(std::ssize(z.pivots())), v); }
};

/// How a reduced system is solved.
struct Krylov {
  bool symmetric;
  double relative, absolute; ///< residual: to that of zero, or itself
  int most_steps;
};

/// Solves by conjugate gradients, or GMRES, for `v`, from where it is. Returns the steps;
/// most_steps + 1 if they did not suffice, or if the preconditioner is not positive definite.
int solve_reduced(ReducedSystem &system, const Krylov &how, Vec right, Vec v);

/// The system of an active set with its multipliers in one matrix, where they cannot be eliminated:
///
///   A u + W^T y = f,      C u = c,
///
/// by a sparse LU factorisation (MUMPS) that the ranks share. Sets u and returns this rank's y.
/// `w`, `c`: constraints x free displacement dofs; `right`: c of this rank's constraints. Throws
/// failure, saying what to try, where the matrix is singular or what is found does not meet the
/// system to 1e-9. Options under hf_saddle_. Collective.
Vector solve_saddle(Mat a, Mat w, Mat c, Vec f, const Vector &right, Vec u);

} // namespace rbvi
