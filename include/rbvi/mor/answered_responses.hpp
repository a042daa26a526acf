// Responses to what the law answers, in place of those to the loads of all multipliers: the law at
// the nodes needs no displacements, and its answers at many mu say which of them there are. Their
// number depends on how far contact moves, not on the mesh.
#pragma once

#include "rbvi/mor/condensed.hpp"
#include "rbvi/mor/orthonormal.hpp"
#include "rbvi/mor/response_space.hpp"

namespace rbvi {

/// Whether only the responses to answers join the modes, where both are possible: the fields of
/// all, one by one, have more than options.large_fields numbers, or A changes and they are many.
bool responses_await(double loads, double dofs, bool varies, const CondensedOptions &options);
/// The same of `loads` of condensed_loads.
bool awaits_answers(const Problem &problem, const CondensedLoads &loads,
                    const CondensedOptions &options);

/// Combinations of loads whose responses come closest in the energy to those of some answers of the
/// law.
class ResponseDirections {
public:
  /// `compliance`: loads^T A^-1 loads. Throws failure where it is not positive definite.
  explicit ResponseDirections(const Matrix &compliance);
  /// Adds directions until every one of these answers (loads x any number) is at most `tolerance`
  /// away from them, relative to the largest answer so far.
  void add(const Matrix &answers, double tolerance);
  /// The largest distance of one of `answers` to the directions taken so far, relative to the
  /// largest answer that was added; both in the energy.
  double left(const Matrix &answers) const;
  /// Coefficients, loads x r, orthonormal in the energy: as few directions as are at most
  /// `tolerance` away from every answer that was added, the parts that add() left out not counted.
  Matrix coefficients(double tolerance) const;
  /// The same, each as large as the answers that were added have it.
  Matrix weighted_coefficients(double tolerance) const;

private:
  Matrix root_;              ///< R with H = R^T R: the energy of loads c is |R c|^2
  OrthonormalColumns space_; ///< R times what was taken
  Matrix parts_;             ///< of the answers in it
  double largest_ = 0;
};

/// Appends the responses to what `model` answers at the training parameters and at random ones: a
/// hundred answers at a time, until another hundred have theirs in the modes to the tolerance;
/// where A changes with mu, at as many A as responses are new to the tolerance. `model`: with the
/// condensed operator of `loads` and any modes. Collective. Throws failure where the law has no
/// answer at any mu, or always new ones.
ResponseSpace append_answered_responses(Problem &problem, const CondensedLoads &loads,
                                        const ReducedModel &model, double tolerance,
                                        LinearBasis &modes);

/// The tolerance of answered_displacements: the error of u in V, relative to each answer but very
/// small ones. Disk with two materials, against full solves: 2.7e-7 (with all responses 1.4e-7),
/// at corners 3.9e-7 with both.
inline constexpr double displacement_tolerance = 1e-6;

/// Whether every displacement of the model costs a factor of A_N, which the law at nodes does not
/// need: then fewer functions make queries faster.
bool factorises_for_displacements(const Problem &problem, const ReducedModel &model);

/// Orthonormal columns, n x k, of the primal space: the modes, and what comes within
/// displacement_tolerance of what the model answers at the training parameters, at corners and
/// faces of the box and at random ones, and within load_tolerance of the responses to its load
/// there. Empty where that is not worth it: k would be 3 n / 4 or more, two thousand answers
/// do not tell, or the model has none. Collective.
Matrix answered_displacements(const Problem &problem, const ReducedModel &model);

} // namespace rbvi
