// What is left of the conditions that an answer meets, of a full body and of a reduced one,
//
//   A u + B^T l = F,      B u <= g, l >= 0, l . (B u - g) = 0 in the normal rows,
//   |l_tau| <= bound, bound |slip| = l_tau . slip in the tangential ones, slip = B u - g there,
//
// each relative to its scale: what balances in it, or, where more than that, a share of the terms
// that this is the sum of, which round-off leaves 1e-16 of: in A u they may cancel by many digits,
// as in a slender beam, and B u and g may be zero, as of a body that fills its box. Where u follows
// from l by one linear solve, as in front of a compliance, the rows of contact are all there is to
// meet; by Nitsche's method, which has no multipliers, equilibrium is. An answer is one where no
// relative residual exceeds its limit.
#pragma once

#include "rbvi/method/node_laws.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <string>

namespace rbvi {

/// Of an answer of a full body: active sets end with round-off, which is refined.
inline constexpr double residual_limit = 1e-10;
/// Of a query: a reduced problem may be far worse conditioned than the body it is of.
inline constexpr double query_residual_limit = 1e-8;
/// By steps that end where they change little, which small steps alone do: Uzawa's method.
inline constexpr double gradient_residual_limit = 1e-2;
/// Of an iteration that ends below a tolerance: it may contract slowly.
inline double limit_of_iteration(double limit, double tolerance) {
  return std::max(limit, 10 * tolerance);
}
/// Throws failure, saying what to try, where the residual is larger or no number.
void check_residual(double residual, double limit, const std::string &advice);

/// A condition: what is left of it, what balances in it, and the terms that this is a sum of.
struct Remainder {
  double left, parts, terms = 0;
};

/// left / max(parts, share terms), where the round-off of the terms is below a tenth of the limit;
/// 0 where nothing is left. NaN where one of them is.
double relative(const Remainder &remainder);

/// All relative.
struct KktResidual {
  double stationarity = 0;    ///< |A u + B^T l - F| to |F| + |B^T l|, terms |diag(A) u|
  double feasibility = 0;     ///< max (B u - g)_+ / weight to max s / weight, normal rows
  double complementarity = 0; ///< sum |l (B u - g)| to |l| |s|
  double sign = 0;            ///< -min l to max |l|, l the normal multipliers
  double friction = 0; ///< max (|l_tau| - bound)_+ to max |l|, sum (bound |slip| - l_tau . slip) to
                       ///< |l| |s|: the larger
  double largest() const;
};

/// The rows of contact at an answer, of some nodes or of all.
struct ContactRemainders {
  const NodeLaws &laws;
  const Vector &weights; ///< per node; one of weight 0 has no constraint
  const Vector &g, &lambda;
  const Vector &excess; ///< B u - g
  /// What terms of equilibrium move a dof by, the largest: |u_i| + (|F_i| + |B^T l|_i) / A_ii over
  /// the dofs, or |B u_0| + |B (u - u_0)| over the rows, u_0 without multipliers. A thousandth of
  /// it, or |g| or |B u| where these are more, is s of a normal row.
  double displacement;
  double stress;       ///< the largest |l|
  Index equations = 0; ///< so many of the last nodes have B u = g and l of either sign
};

/// Their largest entries and sums: what several ranks have is put together entry by entry.
struct ContactSums {
  /// Penetration; s over the weight; -l_n, |l_n| and |l|; (|l_tau| - bound)_+.
  std::array<double, 6> largest{0, 0, -std::numeric_limits<double>::infinity(), 0, 0, 0};
  /// |l_n (B u - g)|; |l|^2; s^2; |bound |slip| - l_tau . slip|.
  std::array<double, 4> sums{};
};

ContactSums sums_of(const ContactRemainders &rows);
/// `tangents`: whether some node has a law of friction.
KktResidual residual_of(const ContactSums &contact, bool tangents, const Remainder &stationarity);
/// Of one process.
inline KktResidual residual_of(const ContactRemainders &rows, const Remainder &stationarity) {
  return residual_of(sums_of(rows), rows.laws.has_tangents(), stationarity);
}
/// Of multipliers from which u follows by a linear solve: g, lambda, w = g - B u and the
/// displacement as ContactRemainders has them, in rows of weight 1.
double residual_of_laws(const NodeLaws &laws, const Vector &g, const Vector &lambda,
                        const Vector &w, double displacement);

} // namespace rbvi
