// What a query of a reduced model gives.
#pragma once

#include "rbvi/contact/interface.hpp"
#include "rbvi/method/answer.hpp"
#include "rbvi/method/balance.hpp"
#include "rbvi/method/residual.hpp"

#include <optional>
#include <string>
#include <vector>

namespace rbvi {

/// u: n coefficients; lambda: R coefficients, >= 0 but for those of the free modes; residual: of
/// the reduced problem, at all nodes of the law where they are known.
struct ReducedAnswer : Answer {
  FullMu mu;
  Vector theta_b;           ///< coefficients of b at this mu, where it separates
  ContactOperators contact; ///< at this mu, where B or G is evaluated
  Vector reaction;          ///< with them, of the law at nodes: B^T x on CondensedOperator::dofs
  /// Of the displacement at these dofs: what the compliance behind the law has beyond the basis. An
  /// answer with it has the gaps of the law. Empty: not known.
  Vector beyond_basis{};
  Vector left{};     ///< of the law at all nodes: H x + q, of which displace() makes the residual
  double energy = 0; ///< a(u,u)/2 - f(u), of the domain alone (not its mirror images)
  double least_pressure = 0; ///< of the peak: where there is at most so much a node counts as free
  /// Largest distance to another answer that was seen, relative to the largest multiplier; 0: none.
  double to_other = 0;
  std::optional<FreeMotions> motions{}; ///< of bodies that contact alone holds
  Vector beta{};                        ///< what their springs are relaxed at
  /// Of OnlineSolver::near: whether a node comes to another state on the way.
  bool passes_kink = false;
};

/// Whether some multiplier is above zero in one of them alone.
inline bool differs_in_contact(const Vector &lambda, const Vector &other) {
  return ((lambda.array() > 0) != (other.array() > 0)).any();
}

/// What the springs of free bodies are relaxed at, and the answer at the same mu with springs
/// relaxed elsewhere, from which a solve starts; empty: from what the samples predict.
struct Relaxed {
  Vector beta{};
  ReducedAnswer before{};
};

/// By which iteration.
enum class OnlineMethod {
  exact,   ///< the fastest one that there is, to round-off
  uzawa,   ///< the law on fewer functions by Uzawa's method, (3.40) or (3.55) to (3.19)
  kacanov, ///< contact that follows the displacement by (A.7) alone, not accelerated
  newton   ///< interpolated operators of Nitsche's method: (4.79) from u_0 = 0, without a rescue
};

/// "exact", "uzawa", "kacanov", "newton".
const std::vector<std::string> &online_method_names();
/// Throws bad_input for another name.
OnlineMethod online_method(const std::string &name);

/// How queries are answered.
struct QueryOptions {
  /// Start from the last answer: queries that follow each other closely cost less, and where there
  /// are several answers the order decides. Else a start is a function of mu and the model alone.
  bool warm = false;
  bool looks_for_others = false; ///< ReducedAnswer::to_other, from further starts
  /// Not given: that of the model's setting "online_method" (OnlineSolver), else exact.
  std::optional<OnlineMethod> method{};
  /// Outputs of the scene that OnlineSolver::outputs computes, by name; empty: all.
  std::vector<std::string> only{};
};

/// One way to answer; what a query changes is its own.
class QueryMethod {
public:
  virtual ~QueryMethod() = default;
  /// `relaxed`: for models with free bodies (solve_balanced).
  virtual ReducedAnswer solve(const FullMu &mu, Relaxed relaxed) = 0;
  /// Sets the displacement of the last answer of solve(), where that leaves it.
  virtual void displace(ReducedAnswer &) {}
  /// The answer at a mu near that of `from`, the last one of solve(), to first order: by the linear
  /// system of its active sets, or Newton's method from it. Nothing: this method solves anew.
  virtual std::optional<ReducedAnswer> near(const ReducedAnswer &, const FullMu &) { return {}; }
};

} // namespace rbvi
