// One linearisation: its condensed operator H = B C B^T, a column when a multiplier asks for it,
// and the two problems that are posed with it.
#pragma once

#include "rbvi/method/nonlinear.hpp"

#include <optional>

namespace rbvi {

class LinearisedContact {
public:
  /// At `state`, under a part (0 ... 1) of the motion and of the loads.
  LinearisedContact(const NonlinearContact &contact, const Vector &state, double part);

  /// (A.9): the laws with B and g of this state. Throws failure, saying what to try.
  Iterate solve(const Iterate &start);
  /// The same with the curvature of the multipliers start.x; without friction. `tolerance` of the
  /// linear systems, relative. None where the active sets do not settle.
  std::optional<Iterate> solve_with_curvature(const Iterate &start, double tolerance);

  const std::vector<Index> &segments() const { return at_.segments; }

private:
  /// Of these, those with an entry in B: the others face nothing.
  std::vector<Index> facing(const std::vector<Index> &active) const;
  Vector diagonal() const;
  /// Makes the columns of C B^T of these multipliers.
  void move(const std::vector<Index> &which);
  /// B C B^T(:, which).
  Matrix columns(const std::vector<Index> &which);
  /// The columns of C B^T of these multipliers, which have been made.
  Matrix moved(const std::vector<Index> &which) const;
  Iterate iterate(Vector x) const;
  std::vector<Index> violated(const std::vector<Index> &active, const Vector &x,
                              const Vector &u) const;

  const NonlinearContact &contact_;
  const Vector &state_;
  const Vector back_; ///< by so much the motion is not all there, beside the state
  const Vector free_; ///< u_0 under the part of the loads
  Linearised at_;
  Vector q_;                  ///< g - B u_0
  std::vector<Vector> moved_; ///< C B^T, a column for each multiplier that was asked for
};

} // namespace rbvi
