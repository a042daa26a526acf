// What a query of a reduced model gives.
#pragma once

#include "rbvi/contact/interface.hpp"
#include "rbvi/method/answer.hpp"

namespace rbvi {

/// u: n coefficients; lambda: R coefficients, >= 0 but for those of the free modes; residual: of
/// the reduced problem, at all nodes of the law where they are known.
struct ReducedAnswer : Answer {
  FullMu mu;
  Vector theta_b;            ///< coefficients of b at this mu, where it separates
  ContactOperators contact;  ///< at this mu, where they do not separate
  Vector reaction;           ///< with them, of the law at nodes: B^T x on CondensedOperator::dofs
  double energy = 0;         ///< a(u,u)/2 - f(u), of the domain alone (not its mirror images)
  double least_pressure = 0; ///< of the peak: where there is at most so much a node counts as free
  /// Largest distance to another answer that was seen, relative to the largest multiplier; 0: none.
  double to_other = 0;
};

/// What is left of the conditions of a query that has an answer: ReducedAnswer::residual.
constexpr double largest_left = 1e-8;

/// How queries are answered.
struct QueryOptions {
  /// Start from the last answer: queries that follow each other closely cost less, and where there
  /// are several answers the order decides. Else a start is a function of mu and the model alone.
  bool warm = false;
  bool looks_for_others = false; ///< ReducedAnswer::to_other, from further starts
};

/// One way to answer; what a query changes is its own.
class QueryMethod {
public:
  virtual ~QueryMethod() = default;
  virtual ReducedAnswer solve(const FullMu &mu) = 0;
};

} // namespace rbvi
