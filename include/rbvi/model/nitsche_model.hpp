// What a reduced model of Nitsche's method has in place of multipliers.
#pragma once

#include "rbvi/core/dense.hpp"

#include <string>
#include <vector>

namespace rbvi {

struct ReducedModel;

/// How a model of Nitsche's method takes the integrals of contact and friction.
enum class CurveRule {
  empirical,   ///< at few Gauss points of the curve, with non-negative weights of their own
  full,        ///< at all of them
  interpolated ///< empirical interpolation over (mu, Newton step) (4.71)-(4.80)
};

/// "empirical", "full", "interpolated".
const std::vector<std::string> &curve_rule_names();

/// An operator on the contact dofs by empirical interpolation (B.36): sum_q theta_q (term q), with
/// theta from J of its entries.
struct LayerTerms {
  Matrix reduced;                 ///< n x J, or of a matrix: a packed lower triangle by columns x J
  Matrix interpolation;           ///< J x J unit lower triangular
  std::vector<int> rows, columns; ///< J contact dofs; a vector has no columns
  double error = 0;               ///< e_EIM reached
  Index size() const { return interpolation.rows(); }
};

/// Nitsche's method: what of the cells beside the contact curve is integrated online. Their dofs
/// are the contact dofs.
struct NitscheModel {
  LayerTerms consistency; ///< a_gamma - a, a matrix
  CurveRule rule = CurveRule::empirical;
  std::vector<int> points;                   ///< empirical: 4 * cell + Gauss point
  Vector factors;                            ///< empirical: of the weights of these points, > 0
  LayerTerms contact_matrix, contact_vector; ///< interpolated: B^n, Theta^n
  /// Interpolated: B^tau, where there are no terms of B^n B^n + B^tau; Theta^tau.
  LayerTerms friction_matrix, friction_vector;
  /// Where a query starts from: P_n, then P_tau of the training samples at the points.
  /// Interpolated: their n coefficients.
  Matrix starts;
  Matrix starts_mu; ///< free parameters x P: where they are
  Matrix states;    ///< n x P: contact that follows the displacement: their coefficients
};

/// How a model of Nitsche's method integrates over the contact curve: "78 of 1264 Gauss points".
std::string describe_curve(const ReducedModel &model);

/// How many terms a_gamma - a has.
Index consistency_terms(const ReducedModel &model);

/// "nitsche empirical": its row in tables of errors.
std::string nitsche_name(const ReducedModel &model);

} // namespace rbvi
