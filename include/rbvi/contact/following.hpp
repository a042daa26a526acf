// Contact that follows the displacement, in front of any body: the problem of method/nonlinear.hpp,
// its condition evaluated on the interfaces at the states of the iteration.
#pragma once

#include "rbvi/contact/contact.hpp"
#include "rbvi/method/nonlinear.hpp"

namespace rbvi {

struct FollowedContact {
  const Contact &contact;
  const FullMu &mu;
  /// Multipliers x by the dual dofs, columns of a dual basis transposed; null: they are the same.
  const SparseMatrix *rows = nullptr;
  Vector slip{};                ///< the history of friction; empty: none
  Vector weights{};             ///< with it: of all normal multipliers
  ContactOperators operators{}; ///< of the last state

  Vector at_dual_dofs(const Vector &x) const {
    return rows == nullptr || x.size() == 0 ? x : Vector(rows->transpose() * x);
  }
};

/// `problem`: all but its condition, which is set; `nodal`: where contact is nodal, for steps on
/// nodes, or null. Throws failure, saying what to try, where the iteration does not converge.
NonlinearResult solve_following(FollowedContact &contact, NodalCompliance *nodal,
                                NonlinearContact &problem, const Start &start,
                                const NonlinearOptions &options);

} // namespace rbvi
