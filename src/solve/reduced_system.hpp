// The equation of the displacement without the dofs that active constraints gave up
// (solve/eliminated.hpp), and its iteration.
#pragma once

#include "elimination.hpp"

namespace rbvi {

/// W^T A Z, with a preconditioner for it. What it refers to must outlive it.
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

} // namespace rbvi
