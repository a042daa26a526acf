// What a query of a reduced model gives.
#pragma once

#include "rbvi/contact/interface.hpp"
#include "rbvi/law/answer.hpp"

namespace rbvi {

/// u: n coefficients; lambda: R coefficients, >= 0 but for those of the free modes; residual: of
/// the reduced problem, at all nodes of the law where they are known.
struct ReducedAnswer : Answer {
  FullMu mu;
  Vector theta_b;           ///< coefficients of b at this mu, where it separates
  ContactOperators contact; ///< at this mu, where they do not separate
  Vector reaction;          ///< with them, of the law at nodes: B^T x on CondensedOperator::dofs
  double energy = 0;        ///< a(u,u)/2 - f(u), of the domain alone (not its mirror images)
  /// Largest distance to another answer that was seen, relative to the largest multiplier; 0: none.
  double to_other = 0;
};

} // namespace rbvi
