// A_N(mu) whose terms differ on few functions (StiffnessChange): one factor L of A_1 serves all mu.
// With an orthonormal basis U of L^-1 Q,
//
//   A_N = s L (I + U K U^T) L^T = R R^T,   R = sqrt(s) L (I + U (M - I) U^T),   M^2 = I + K,
//
// s = sum of theta_q scales_q, and K = U^T L^-1 (sum of theta_q Q C_q Q^T / s) L^-T U is small.
#pragma once

#include "rbvi/rom/model/model.hpp"

namespace rbvi {

class ChangedStiffness {
public:
  /// `model` must outlive it. Throws failure where A_1 is not positive definite.
  explicit ChangedStiffness(const ReducedModel &model);
  /// The coefficients of the next calls: s. Throws failure where A_N is not positive definite.
  double set(const Vector &theta);
  void solve_fixed(Matrix &x) const; ///< L^-1 x
  /// (I + U (M - I) U^T)^-1 x, of x = L^-1 y it is sqrt(s) R^-1 y.
  void solve_change(Matrix &x) const;
  void solve_root(Vector &x) const;       ///< sqrt(s) R^-1 x
  void solve_transposed(Vector &x) const; ///< sqrt(s) R^-T x
  Vector times(const Vector &u) const;    ///< A_N u

private:
  const ReducedModel &model_;
  Matrix a_, l_;     ///< A_1 and L, their lower triangles
  Matrix u_, along_; ///< U, n x min(n, r); U^T L^-1 Q
  Matrix core_;      ///< sum of theta_q C_q
  Matrix inverse_;   ///< M^-1 - I
  double scale_ = 1;
};

} // namespace rbvi
