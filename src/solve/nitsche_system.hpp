// One system of Nitsche's method at a time, and the PETSc objects that outlive it.
// Niakh (2022): (4.27)-(4.32), (4.45)-(4.48), (4.56)-(4.59).
#pragma once

#include "local_frames.hpp"
#include "rbvi/solve/nitsche.hpp"

#include <exception>
#include <optional>

namespace rbvi {

struct NitscheSystem {
  NitscheSystem(const NitscheSolver &solver, const Problem &problem, const NitscheOptions &options);

  const NitscheSolver &solver;
  const Problem &problem;
  const NitscheLayer layer;
  const NitscheOptions &options;
  std::vector<PetscInt> rows; ///< of the contact dofs
  std::optional<LocalFrames> frames;
  Handle<SNES> snes;
  Handle<Mat> a_gamma, tangent;
  Handle<Vec> au, ay, force; ///< scratch
  double accuracy = 1e-12;   ///< of the residual, relative to its terms: -nitsche_snes_rtol
  double small_residual = 0; ///< its norm, below which it is accurate, too: -nitsche_snes_atol
  double linear_tolerance = 1e-2;

  // At mu; with local frames in their unknowns. Where contact follows u, faces are at its last one.
  Handle<Vec> f, upper; ///< upper: where the normal displacement is bounded
  std::vector<NitscheFace> faces;
  FullMu mu;
  Vector bounds; ///< of friction

  // While SNES works.
  double tolerance = 1e-12;
  double scale = 0;          ///< of the last residual: the norms of its terms
  double smallest_scale = 0; ///< where the answer is zero all its terms are round-off
  int factorisations = 0;
  bool finished = false;   ///< the solve before: a factorisation that fails leaves one of no use
  bool factorised = false; ///< in this step
  std::exception_ptr failed;

  Vector on_layer(Vec u) const { return restrict_to(problem.trace(), u); }
  void turn_to(Vec u) { rbvi::turn_to(layer, mu, on_layer(u), faces); }
  void set_bounds(Vec u) { bounds = nitsche_bounds(faces, nitsche_pressures(faces, on_layer(u))); }
  bool bounds_move() const { return rbvi::bounds_move(faces); }

  /// Collective, as are all below.
  void set(const Operators &op);
  void residual(Vec u, Vec r);
  void jacobian(Vec u, Mat matrix);
  double energy(Vec u);
  /// One linear solve for u, where contact and stick are those of `start`. Sets the bounds, too.
  void predict(const NitscheStart &start, const Vector &friction_bounds, Vec u);
  /// Where nothing is known: contact where u = 0 penetrates deeply; no friction whose bound moves.
  void predict_from_rest(Vec u);
  /// Newton steps from u, in place. Returns their number; throws failure.
  int newton(Vec u, std::string &reason);
  /// The part that the residual has of its terms; where a bound holds u back it may push.
  double relative_residual(Vec u);

private:
  void make_snes(const Operators &op);
  void set_callbacks();
  void set_linear_solver();
  void before_step();
  void check_linear_solve() const;
  void search(SNESLineSearch line);
};

} // namespace rbvi
