// The equation of the displacement without the dofs that active constraints gave up
// (solve/eliminated.hpp), and its iteration.
#pragma once

#include "rbvi/contact/elimination.hpp"
#include "rbvi/fem/trace.hpp"

namespace rbvi {

/// Zero at these dofs. Not collective.
void set_zero(const Trace &dofs, Vec v);

/// W^T A Z, with a preconditioner for it.
struct ReducedSystem {
  /// The eliminations, of u by the constraints and of the forces by their multipliers, must outlive
  /// it. `preconditioner`: of A, or of A without the pivots.
  ReducedSystem(const Trace &trace, Mat stiffness, const Elimination &of_constraints,
                const Elimination &of_forces, const std::vector<Index> &given_up,
                KSP preconditioner);

  /// v + what the constraints without right-hand side say of the pivots, where v is zero.
  void extend(Vec v) const;
  /// W^T r, zero at the pivots.
  void reduce(Vec r) const;

  Mat a;
  const Elimination &z, &w;
  Trace pivots, coupled_by_z, coupled_by_w;
  KSP factor;
  Handle<Vec> scratch;
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

} // namespace rbvi
