// Contact with friction on a linear basis of (lambda_n, lambda_tau) together, by least squares on
// equations at collocation nodes: with x = (N y, T y) at node j and w = (W y + q)_j the law says
//
//   apart:            x_n = 0, x_tau = 0
//   together:         w_n = 0   and   sticking: w_tau = 0,   slipping: x_tau = s (c_j x_n + t_j)
//
// (s = -1 or 1, against w_tau). In a basis that holds the solution the equations of the true states
// agree; with more of them than modes the least-squares solution averages what the basis misses.
// The states follow from the solution as in friction.hpp, until they repeat.
#pragma once

#include "rbvi/law/friction/friction.hpp"

namespace rbvi {

/// Rows at the collocation nodes (J of them), columns: k modes.
struct LeastSquaresProblem {
  Matrix normal, tangential;         ///< N, T: J x k
  Matrix gap_rows, slip_rows;        ///< W: J x k each
  Vector gap, slip;                  ///< q: J each
  Vector gap_scale, slip_scale;      ///< diagonal of H at the nodes: makes both kinds of rows alike
  std::vector<FrictionBound> bounds; ///< of each node; a single one: of all
};

/// State of a node and the direction of its slip (x_tau = direction * bound). Sticking: direction
/// 0. Open: x_tau = 0; where the threshold acts across the gap, direction 0 is w_tau = 0 and -1 or
/// 1 is x_tau = direction * t. Without a bound, nodes in contact slip with direction 0.
struct SlipState {
  NodeState state = NodeState::open;
  int direction = 0;
  friend bool operator==(const SlipState &, const SlipState &) = default;
};

struct LeastSquaresResult {
  Vector y; ///< k coefficients
  std::vector<SlipState> states;
  int iterations = 0;
  /// Largest violation of the laws at the nodes (where the states have settled: of the equations),
  /// relative to the largest x, in unit-diagonal scaling.
  double residual = 0;
  bool converged = false;
  std::string reason;
};

/// Converged: the states have settled, or alternate at nodes that the residual leaves undecided.
/// That says nothing of the size of the residual: it is small if and only if the basis holds the
/// solution (and the nodes determine its coefficients). Equations that do not determine all modes:
/// the coefficients of minimum norm, and the reason says so. `start`: states of a nearby problem,
/// or empty (a coarse basis can have more than one set of states: start nearby). Throws failure for
/// sizes that do not fit, entries that are not finite, or fewer equations than modes.
LeastSquaresResult solve_least_squares(const LeastSquaresProblem &problem,
                                       const std::vector<SlipState> &start = {});

/// Collocation nodes for a basis by QR with column pivoting of its values: the rows of `basis` (2 m
/// x k: normal values at m nodes, then tangential ones) that determine its coefficients best, each
/// node once, in order of importance, `count` of them; nodes that are as important: the lowest
/// first. k + 2 or more are a good choice: where contact replaces values by gaps, fewer leave modes
/// loose. Throws failure for a basis that is empty or not finite and a count beyond 0 ... m.
std::vector<int> pivot_nodes(const Matrix &basis, int count);

} // namespace rbvi
