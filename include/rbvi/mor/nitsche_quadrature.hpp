// What a reduced model of Nitsche's method takes of the contact curve: the cells beside it, the
// terms that keep the method consistent, and how contact and friction are integrated.
// Niakh (2022): (4.86).
#pragma once

#include "rbvi/core/variants.hpp"
#include "rbvi/fem/problem.hpp"
#include "rbvi/model/model.hpp"
#include "rbvi/mor/pod.hpp"
#include "rbvi/sweep/sweep.hpp"

#include <array>
#include <vector>

namespace rbvi {

struct CurveOptions {
  CurveRule rule = CurveRule::empirical;
  /// empirical: largest error of u, relative, that the points add at a training parameter; 0:
  /// what the modes leave.
  double tolerance = 0;
  double eim_tolerance = 1e-6; ///< interpolated: of the matrices and vectors (B.32)
  /// interpolated, with friction: the pairs of (4.73) as published. Of Tresca's law those of plain
  /// steps, with B^n + B^tau in place of either; else the ends of the loops (4.63) alone.
  bool published_pairs = false;
  /// interpolated: the errors over the Newton steps at these are reported, too.
  std::vector<Mu> eim_validation;
};

/// e_EIM along the terms (B.32): over the training pairs (mu, Newton step), over those of other mu
/// (4.85), and over their last steps alone (4.87).
struct EimErrors {
  std::vector<double> training, validation, converged;
};

struct CurveReport {
  // Empirical: after each pass, with the largest relative error of u that it adds at a training
  // parameter; the last is what the model has.
  std::vector<int> points;
  std::vector<double> error;
  // Interpolated.
  std::array<EimErrors, 4> eim_errors; ///< as in NitscheModel: B^n, Theta^n, B^tau, Theta^tau
  int states = 0;                      ///< pairs (mu, Newton step)
};

/// Sets terms of contact and friction in model.contact.nitsche, and their report. Collective.
using TermInterpolation = void (*)(Problem &problem, const std::vector<Sample> &samples,
                                   const CurveOptions &options, ReducedModel &model,
                                   CurveReport &report);
/// Those that a rule has; for users that is `interpolated_name`.
std::map<CurveRule, TermInterpolation> &term_interpolations();
inline constexpr const char *interpolated_name = "-nitsche_quadrature interpolated";

/// Fills model.contact.nitsche; the rest of the model is there. `coefficients`: of the samples in
/// the modes, n x P (interpolated alone asks for them). `u_left`: relative error that the modes
/// leave in u. Collective. Throws failure where a reduced problem has no answer at a training
/// parameter.
CurveReport reduce_curve(Problem &problem, const std::vector<Sample> &samples,
                         const Matrix &coefficients, double u_left, const CurveOptions &options,
                         ReducedModel &model);

} // namespace rbvi
