// How well the terms of a model sum up to its operators, along their number (3.61):
//
//   e(j) = max over mu of |B(mu) - sum over q <= j of theta_q(mu) B_q| / max over mu of |B(mu)|
//
// in the largest entry, over the set that the terms come from and over another one.
// Niakh (2022): (3.62).
#pragma once

#include "rbvi/fem/problem.hpp"
#include "rbvi/model/model.hpp"

namespace rbvi {

struct SeparationErrors {
  /// a, b, f or g; where B^n and B^tau are interpolated apart b_normal and b_tangential.
  std::string name;
  std::vector<double> training, validation; ///< with 0, 1, ..., J terms
};

/// Collective. Of every operator of the model that has interpolated terms, of a and f the sum of
/// those alone. `problem`: of the model's scene and
/// mesh; `validation`: free parameters. The terms are assembled again at the training mu that they
/// were chosen at, their coefficients are those of a query. Throws failure if the model does not
/// say which these mu are.
std::vector<SeparationErrors> separation_errors(Problem &problem, const ReducedModel &model,
                                                const std::vector<Mu> &validation);

struct StateSeparation {
  SeparationErrors errors;
  /// Singular values of the training states' B, as columns of entries, above the tolerance times
  /// the largest: as many terms would do, were every entry of B known at a query.
  int svd_rank;
  int multipliers; ///< whose rows the interpolated entries are in: edges beside them are evaluated
};

/// What empirical interpolation of B over (mu, state) would leave, where contact follows the
/// displacement: how many terms `tolerance` takes on the training states, and what they leave on
/// the others. A comparison: models assemble B at every state. Serial; neither set is empty.
StateSeparation separation_over_states(const Contact &contact, const ParameterSpace &space,
                                       const std::vector<ContactPoint> &training,
                                       const std::vector<ContactPoint> &validation,
                                       double tolerance);

} // namespace rbvi
