// The online stage: one parameter in, one checked answer out. Serial; allocates only when built.
#pragma once

#include "rbvi/core/nonnegative_qp.hpp"
#include "rbvi/core/outputs.hpp"
#include "rbvi/rom/model.hpp"

namespace rbvi {

struct ReducedSolution {
  Vector u; ///< n coefficients
  Vector x; ///< R coefficients, >= 0
  Vector theta_b; ///< coefficients of b at this mu
  double kkt_residual = 0; ///< of the reduced problem, relative: stationarity, feasibility, complementarity
  int iterations = 0;      ///< active-set updates
};

/// Answers queries on a model it does not own; keeps the last active set as the next start.
class OnlineSolver {
public:
  explicit OnlineSolver(const ReducedModel &model);
  /// `mu`: the free parameters; throws bad_input outside the box unless `extrapolate`. Throws
  /// failure, saying what to try, if the reduced constraints contradict each other, if the reduced
  /// stiffness is not positive definite, or if the KKT residual exceeds 1e-8.
  ReducedSolution solve(const Mu &mu, bool extrapolate = false);
  /// Energy, forces and contact measures of an answer, at a cost that depends on the contact region
  /// alone (min_u is left unset: it needs the full field).
  Outputs outputs(const Mu &mu, const ReducedSolution &solution) const;
  Vector multiplier(const ReducedSolution &solution) const; ///< at the dual dofs
  Vector field(const ReducedSolution &solution) const;      ///< at all dofs (needs the fields)

private:
  struct Workspace;
  const ReducedModel &model_;
  Scene scene_;
  NonnegativeQp qp_;
  Matrix a_, b_, y_;
  Vector f_, g_, c_;
};

/// theta_q(mu): the sampled entries re-assembled, then the triangular solve (B.36).
Vector affine_coefficients(const AffineTerms &terms, const Form &form, const Scene &scene,
                           const Mu &all_parameters);

} // namespace rbvi
