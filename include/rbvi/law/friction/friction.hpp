// Contact with friction, condensed on the multipliers of m nodes: find x = (x_n, x_tau) with
//
//   w = H x + q,      H: symmetric positive definite, q
//   x_n >= 0,   w_n >= 0,   x_n . w_n = 0
//   x_tau,i = Proj_{s_i}(x_tau,i - rho w_tau,i),      |x_tau,i| <= s_i = c x_n,i + t_i,   rho > 0
//
// H = B A^-1 B^T, q = g - B A^-1 f, x = lambda; w_n is the gap that is left, -w_tau the slip. The
// fixed point of corrected (3.32), component by component: Coulomb has t = 0, Tresca c = 0. The
// tangential part of node i is m + i (d - 1), ..., of d - 1 components; its bound is a disk.
//
// Semismooth Newton (primal-dual active sets), columns of H asked for when first needed. Where it
// cycles or stalls, the bounds s are frozen: what is then left is convex, and is solved by a method
// that always ends; the fixed point over s comes back to Newton when it is close.
#pragma once

#include "rbvi/law/lcp.hpp"

#include <algorithm>

namespace rbvi {

/// The bound s = c x_n + t of |x_tau| at every node.
struct FrictionBound {
  double coefficient = 0;       ///< c >= 0
  double threshold = 0;         ///< t >= 0
  bool only_in_contact = false; ///< t = 0 at nodes that carry no pressure

  double threshold_at(double x_n) const { return x_n > 0 || !only_in_contact ? threshold : 0.0; }
  /// s; a negative x_n counts as zero.
  double value(double x_n) const { return coefficient * std::max(x_n, 0.0) + threshold_at(x_n); }
  /// Whether t appears only when the node touches, so that s is not continuous.
  bool jumps() const { return only_in_contact && threshold > 0; }
  /// Whether x_tau of a node can differ from zero.
  bool carries_traction(bool in_contact) const {
    if (threshold > 0) return in_contact || !only_in_contact;
    return in_contact && coefficient > 0;
  }
  /// Throws bad_input for a coefficient or a threshold that is negative or not finite.
  void check() const;
};

/// Where a node is: apart or together, sticking or slipping.
enum class NodeState : char { open, stick, slip };

struct FrictionOptions {
  double tolerance = 1e-13; ///< relative, as LcpOptions::tolerance; the bound as x
  int max_iterations = 500; ///< linear systems in all
};

struct FrictionResult {
  Vector x, w;  ///< m * dim entries each
  Vector start; ///< x - w / H_jj (the mean of a node's tangential H_jj; where they were not asked
                ///< for, of all others): its signs and its sizes against the bound tell every
                ///< state. Smooth where x and w are not: start nearby problems from it, or from
                ///< interpolants of several
  std::vector<Index> active;     ///< nodes with x_n > 0, increasing
  std::vector<NodeState> states; ///< state of every node; an open one can slip or stick by Tresca:
                                 ///< its state is open all the same
  int iterations = 0;            ///< linear systems solved
  int columns = 0;               ///< columns of H that were asked for
  int backup_steps = 0;          ///< fixed-point steps after a cycle
  double residual = 0;           ///< largest relative violation of the three laws
  bool converged = false;
  std::string reason; ///< why it stopped; not converged: what to try
};

/// `q`: m * dim entries (m nodes), dim = 2 or 3; 1: there is no tangential part. `start`: a first
/// guess of x, or better of FrictionResult::start, or empty. Without a bound (c = t = 0) this is
/// solve_lcp on the normal part. Throws failure for entries that are not finite or sizes that do
/// not fit; bad_input for a negative bound.
FrictionResult solve_friction(const ColumnSource &columns, const Vector &q, int dim,
                              const FrictionBound &bound, const Vector &start = {},
                              const FrictionOptions &options = {});

} // namespace rbvi
