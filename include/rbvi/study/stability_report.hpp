// The inf-sup constants of a finished model, over sets of parameters and, where contact follows the
// displacement, of the states of its iterations. Niakh (2022): (1.13), (A.3), (A.4).
#pragma once

#include "rbvi/fem/problem.hpp"
#include "rbvi/model/model.hpp"
#include "rbvi/mor/stability.hpp"

namespace rbvi {

/// A model's bases in the coordinates of mor/stability.hpp.
struct StabilityCheck {
  RieszSpace space;
  Matrix coordinates; ///< (n_c + n) x n: the N modes, then the supremizers
  Matrix dual;        ///< orthonormal basis of the span of the generators; on a support of the
                      ///< functions of both multipliers together
  int modes = 0;
};

/// Collective. `problem`: on all ranks; `model`: of a reduced pair of spaces.
StabilityCheck make_stability_check(Problem &problem, const ReducedModel &model);

/// All constants at each mu, shared among the ranks, on every rank. Collective on `comm`;
/// `b_is_scaled`: those of the high-fidelity pair are computed once and scaled.
std::vector<InfSup> infsup_over(MPI_Comm comm, Problem &problem, const StabilityCheck &check,
                                const std::vector<ContactPoint> &set, bool b_is_scaled);

/// The mu of a set with the smallest |b(mu)|, the first among equals: where b is only
/// scaled it has the smallest constants of all. Not collective.
ContactPoint weakest_form(Problem &problem, const std::vector<ContactPoint> &set);

/// What the model's space guarantees over a set: beta_off >= sqrt(1 - sigma^2) beta_on.
struct BoundCheck {
  double smallest = 0; ///< beta_off over its bound, at worst
  int exceptions = 0;  ///< parameters at which it falls short by more than round-off
};

/// The bound at every mu of the set, shared among the ranks. Collective on `comm`.
BoundCheck check_bound(MPI_Comm comm, Problem &problem, const StabilityCheck &check,
                       const std::vector<ContactPoint> &set);

/// What the first supremizers achieve, the worst over a set.
struct StabilityRow {
  int supremizers = 0;
  double sigma = 0;     ///< largest sigma_S(mu) (2.21)
  double condition = 0; ///< largest sigma_S c_S / beta_on: (2.23) holds where it is below 1
  double classic = 0;   ///< smallest beta_S^* / beta_on (2.24): no statement where negative
  double bound = 0;     ///< smallest sqrt(1 - sigma^2)
  double ratio = 0;     ///< smallest beta_off / beta_on
  double beta = 0;      ///< smallest beta_off
  int exceptions = 0;   ///< mu with beta_off < sqrt(1 - sigma^2) beta_on by more than round-off
};

/// One row for each number of supremizers in `counts` (increasing). Collective on `comm`.
std::vector<StabilityRow> stability_along(MPI_Comm comm, Problem &problem,
                                          const StabilityCheck &check,
                                          const std::vector<ContactPoint> &set,
                                          const std::vector<int> &counts);

/// The fewest supremizers with beta_off >= fraction * beta_on at every mu of the set; -1 if all are
/// not enough. beta_off grows with every supremizer. Collective on `comm`.
int fewest_supremizers(MPI_Comm comm, Problem &problem, const StabilityCheck &check,
                       const std::vector<ContactPoint> &set, double fraction);

} // namespace rbvi
