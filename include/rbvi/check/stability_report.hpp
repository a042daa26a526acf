// The inf-sup constants of a finished model, over sets of parameters.
#pragma once

#include "rbvi/mor/stability.hpp"
#include "rbvi/problem/problem.hpp"
#include "rbvi/rom/model.hpp"

namespace rbvi {

/// A model's bases in the coordinates of mor/stability.hpp.
struct StabilityCheck {
  RieszSpace space;
  Matrix coordinates; ///< (n_c + n) x n: the N modes, then the supremizers
  Matrix dual;        ///< orthonormal basis of the span of the generators
  int modes = 0;
};

/// Collective. `problem`: on all ranks.
StabilityCheck make_stability_check(Problem &problem, const ReducedModel &model);

/// The four constants at each mu, shared among the ranks; all four on every rank. Collective on
/// `comm`; `b_is_scaled`: beta_HF is computed once and scaled.
std::vector<InfSup> infsup_over(MPI_Comm comm, Problem &problem, const StabilityCheck &check,
                                const std::vector<Mu> &set, bool b_is_scaled);

/// Smallest beta_off / beta_on over the set with the first `supremizers` columns. Collective.
double smallest_ratio(MPI_Comm comm, Problem &problem, const StabilityCheck &check,
                      const std::vector<Mu> &set, int supremizers);

/// The fewest supremizers with smallest_ratio >= fraction, by bisection (the ratio grows with every
/// supremizer); -1 if all are not enough. Collective.
int fewest_supremizers(MPI_Comm comm, Problem &problem, const StabilityCheck &check,
                       const std::vector<Mu> &set, double fraction);

} // namespace rbvi
