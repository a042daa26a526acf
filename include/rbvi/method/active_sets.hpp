// Contact by active sets, for solvers that have the body itself in place of columns of
// H = B A^-1 B^T. The sets make the laws of friction.hpp linear equations,
//
//   x = fixed + T y,    R^T w = 0,    w = g - B u,    A u + B^T x = f,
//
// one unknown y for each: the pressure of a node in contact, the tangential multipliers of one that
// sticks. Under Coulomb's law the traction of a node that slips comes with its pressure: there T
// has an entry more than R. Otherwise they are the same, and the system is symmetric.
#pragma once

#include "rbvi/method/friction.hpp"

#include <functional>

namespace rbvi {

struct SetSystem {
  SparseMatrix t, r; ///< rows of the multipliers x unknowns
  Vector fixed;      ///< of x: the thresholds of nodes that slip
  bool symmetric = true;
};

struct SetSolution {
  Vector x, w;
  Vector terms; ///< the sum of the sizes of the terms of every row of w
};

/// Solves one such system, `accuracy` relative.
using SetSolver = std::function<SetSolution(const SetSystem &system, double accuracy)>;

/// Where each rank has some of the nodes: makes every entry the largest of those of all ranks.
/// Empty: all nodes are here.
using LargestOverRanks = std::function<void(Vector &)>;

struct SetOptions {
  FrictionOptions friction{};
  LargestOverRanks largest{};
  bool by_rule = false; ///< as friction_answer
};

/// Semismooth Newton as in solve_friction, also where there is no friction; the systems are solved
/// as exactly as the sets need, that of the last sets to the tolerance. `diagonal`: the order
/// of magnitude of H_jj, positive, which weighs a slip against a traction; the answer does not
/// depend on it. Where the sets return, it is not converged: nothing else is tried. Throws failure
/// for friction in three dimensions.
FrictionResult solve_by_sets(const SetSolver &solve, const Vector &diagonal, const NodeLaws &laws,
                             const Vector &start, const SetOptions &options = {});

} // namespace rbvi
