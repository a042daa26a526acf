// Contact with a rigid support by Nitsche's method (Niakh 2022, 4.3): no multipliers, one nonlinear
// system A_gamma u + (contact and friction of the curve) = F, solved by SNES with its VI extension
// (infinite bounds: Newton's method). With fixed bounds of friction the system is the gradient of a
// convex energy, and the line search finds its minimum along each step. Bounds that depend on u
// (Coulomb's) are frozen in an outer loop (4.63), or follow every Newton step (4.53).
//
// A tangent differs from the last one at a few points of the curve alone: conjugate gradients with
// an earlier factorisation solve it, and it is factorised anew where they take more than a few
// iterations.
// Niakh (2022): (4.21), (4.22), (4.24)-(4.26), (4.54), (4.55), (4.60)-(4.62), (4.64).
// Niakh (2022): Remark 4.3.1.
#pragma once

#include "rbvi/contact/nitsche_curve.hpp"
#include "rbvi/fem/problem.hpp"

#include <functional>
#include <memory>
#include <string>

namespace rbvi {

struct NitscheOptions {
  bool single_loop = false;    ///< moving bounds of friction: (4.53) instead of (4.63)
  bool plain_steps = false;    ///< as printed (4.23), (4.41), (4.53), from u = 0: no line search
  bool nonpenetration = false; ///< SNES bounds the normal displacement of the nodes by the gap
};

/// Where Newton starts: what is in contact and sticks by these pressures, which those at nearby mu
/// predict better than their displacements do.
struct NitscheStart {
  Vec u; ///< the displacement of some nearby mu
  Matrix pressures;
};

struct NitscheSolution {
  Handle<Vec> u;       ///< free dofs, without the motion
  Matrix pressures;    ///< at the points of the curve, see nitsche_pressures
  Vector bounds;       ///< of friction there
  Vector layer;        ///< u at the contact dofs
  double energy = 0;   ///< a(u,u)/2 - f(u) (4.11)
  double residual = 0; ///< |A_gamma u - F + terms| / (|A_gamma u - F| + |terms|)
  int iterations = 0;  ///< Newton steps
  int outer_iterations = 0;
  int factorisations = 0;
  std::string reason;
};

struct NitscheSystem;

class NitscheSolver {
public:
  /// Collective. SNES, KSP and PC options under -nitsche_; rtol is that of the residual, relative
  /// to its terms at the start, atol that of its norm. `problem` must outlive it; its contact is by
  /// Nitsche's method.
  NitscheSolver(Problem &problem, const NitscheOptions &options);
  ~NitscheSolver();
  /// Collective. `op`: the problem assembled at some mu; `start`: null: u = 0, in contact where its
  /// penetration is above half of the largest; plain steps take none. Throws failure, saying what
  /// to try, where SNES does not converge or a tangent is not positive definite (gamma0 too small).
  NitscheSolution solve(const Operators &op, const NitscheStart *start = nullptr);
  /// Called with u at the contact dofs at the start of every Newton step, and the bounds of
  /// friction.
  std::function<void(const Vector &layer, const Vector &bounds)> watch;
  /// Where it is given, every loop is solved to its end, and this is called there with the same.
  std::function<void(const Vector &layer, const Vector &bounds)> loop_end;

private:
  void run(bool nested, Vec u, NitscheSolution &result);
  NitscheOptions options_;
  std::unique_ptr<NitscheSystem> system_;
};

} // namespace rbvi
