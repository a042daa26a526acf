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

#include "rbvi/method/lcp.hpp"
#include "rbvi/method/node_laws.hpp"

namespace rbvi {

/// Where a node is: apart or together, sticking or slipping.
enum class NodeState : char { open, stick, slip };

struct FrictionOptions {
  double tolerance = 1e-13; ///< relative, as LcpOptions::tolerance; the bound as x
  int max_iterations = 500; ///< linear systems in all
};

struct FrictionResult {
  Vector x, w;  ///< laws.rows entries each
  Vector start; ///< x - w / H_jj (the mean of a node's tangential H_jj; where they were not asked
                ///< for, of all others): its signs and its sizes against the bound tell every
                ///< state. Smooth where x and w are not: start nearby problems from it, or from
                ///< interpolants of several
  std::vector<Index> active;     ///< nodes with x_n > 0, increasing
  std::vector<NodeState> states; ///< state of every node; an open one can slip or stick by Tresca:
                                 ///< its state is open all the same
  int iterations = 0;            ///< linear systems factorised
  int columns = 0;               ///< columns of H that were asked for
  int backup_steps = 0;          ///< fixed-point steps after a cycle
  double residual = 0;           ///< largest relative violation of the three laws
  bool converged = false;
  std::string reason; ///< why it stopped; not converged: what to try
};

/// `q`: laws.rows entries. `start`: a first guess of x, or better of FrictionResult::start, or
/// empty. Where no node has a bound above zero this is solve_lcp on the normal part. Throws failure
/// for entries that are not finite or sizes that do not fit; bad_input for a negative bound.
FrictionResult solve_friction(const ColumnSource &columns, const Vector &q, const NodeLaws &laws,
                              const Vector &start = {}, const FrictionOptions &options = {});

} // namespace rbvi
