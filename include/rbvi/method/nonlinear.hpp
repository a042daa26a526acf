// Contact whose condition depends on the displacement (Niakh 2022, appendix A), on the contact dofs
// of an elastic body: find (u, x) with
//
//   u = u_0 - C B(u)^T x,      x and w = g(u) - B(u) u by the laws of contact and friction,
//
// C = E^T A^-1 E the compliance, u_0 the displacement under the loads alone. Kacanov's iteration
// (A.7) linearises at the state s, solves that problem exactly and takes its u as the next state:
// sequential quadratic programming without the curvature K = d(B(s)^T x)/ds. Newton's method adds
// the load -K (u - s) and is quadratic; without friction. Anderson's acceleration combines the last
// states of Kacanov's iteration. Niakh (2022): (1.14)-(1.17), (A.10).
#pragma once

#include "rbvi/method/friction.hpp"
#include "rbvi/method/nodal.hpp"
#include "rbvi/method/starts.hpp"

#include <functional>

namespace rbvi {

/// B(s) u <= g(s) in the normal rows; in the others B u - g is the slip.
struct Linearised {
  SparseMatrix b;
  Vector g;
  std::vector<Index> segments{}; ///< of two meshes: what faces what (ContactOperators::segments)
};

/// K = -(S^T E + E^T S).
struct CurvatureRows {
  SparseMatrix s, e;
};

/// What steps with the tangent between nodes need.
struct NodalContact {
  NodalEvaluation evaluate;
  NodalCompliance &compliance;
};

/// A solution of one linearised problem.
struct Iterate {
  Vector x{};
  Vector start{};    ///< with friction: where the next starts
  Vector diagonal{}; ///< H_jj; where the column was not asked for the mean of the others
  Vector u{};
  Vector reaction{}; ///< load on the contact dofs: u = u_0 - C reaction
  std::vector<Index> active{};
};

struct NonlinearContact {
  std::function<void(const Vector &state, Linearised &at_state)> linearise{};
  /// Empty: there is none.
  std::function<CurvatureRows(const Vector &state, const Vector &x)> curvature{};
  Compliance *compliance = nullptr;
  Vector free;       ///< u_0
  Vector undeformed; ///< the state in which nothing has moved
  NodeLaws laws;
  SparseMatrix
      w_product; ///< Gram matrix of the multipliers; empty: their coefficients are measured
  /// Only where the rows of x are the normal ones of all nodes, then the tangential ones.
  std::optional<NodalContact> nodal{};
  /// Instead of B, g and the compliance: x and u of the problem linearised at a state, which it may
  /// move to one where there is a problem. Then NonlinearResult has no start and no residual.
  std::function<Iterate(Vector &state)> solve{};
  std::string advice{}; ///< where it does not settle; empty: other methods
};

enum class NonlinearMethod {
  automatic, ///< nodal where contact offers it; else, and where that fails, newton where there is a
             ///< curvature and no friction, else kacanov
  kacanov,
  newton,   ///< where there is a curvature and no friction
  anderson, ///< Kacanov's iteration, accelerated with three earlier states
  nodal     ///< with the tangent between nodes, where contact offers it: nodal.hpp; with friction
            ///< Kacanov's, accelerated likewise
};

/// "auto", "kacanov", "newton", "anderson", "nodal".
const std::vector<std::string> &nonlinear_method_names();

struct NonlinearOptions {
  NonlinearMethod method = NonlinearMethod::automatic;
  double tolerance = 1e-10; ///< of (A.8), both
  int max_steps = 60;
  int load_steps = 8; ///< where the first attempt fails
  /// nodal: iterates near contact alone, and no step that would only confirm the last one: the
  /// tolerance is of what the next is expected to change.
  bool economical = false;
};

struct NonlinearResult {
  Vector x;
  Vector start;    ///< x - w / H_jj (FrictionResult::start)
  Vector state;    ///< u
  Vector reaction; ///< B(u)^T x
  std::vector<Index> active;
  std::vector<Vector> iterates; ///< the states at which the condition was linearised, in order
  int steps = 0;                ///< linearisations
  int load_steps = 0;           ///< 0: from the start at once
  int segments_moved = 0;       ///< the last step with other segments than the one before; 0: none
  /// (A.8) of the last step: the energy norm of the change of u over that of u - u_0, and the norm
  /// of the change of x in W over that of x.
  double change_u = 0, change_x = 0;
  double residual = 0; ///< of the laws with the condition at the solution: residual_of_laws
  double rate = 0;     ///< contraction: the change of the last step over that of the one before
  Vector last_x;       ///< not converged: x of the last step; empty: there is none
  bool converged = false;
  std::string reason; ///< why it stopped; not converged: what to try
};

/// Where steps from `start` fail, once more from the undeformed body in load steps: a part of the
/// motion and of the loads after the other. Never throws for a condition or a law that fails;
/// throws bad_input for a method that this contact has not.
NonlinearResult solve_nonlinear(const NonlinearContact &contact, const Start &start,
                                const NonlinearOptions &options = {});

} // namespace rbvi
