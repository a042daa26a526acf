// A body with a part whose stiffness a coefficient scales, A(kappa) = A_rest + kappa A_part, both
// sums of exact terms, and no load. The part acts on the rest through its interface alone, by kappa
// S, S its Schur complement there. So one factorisation, at kappa_0, serves every kappa: with delta
// = kappa - kappa_0, G = E^T A(kappa_0)^-1 E on the contact dofs c and the interface i, and the
// eigenvectors
//
//   S v = sigma G_ii^-1 v,   W = G_ii^-1 V,   Y = G_ci W,   phi = delta sigma / (1 + delta sigma),
//
//   E_c^T A(kappa)^-1 E_c = G_cc - Y diag(phi) Y^T
//   A(kappa)^-1 E_c r     = A(kappa_0)^-1 (E_c r - E_i W diag(phi) Y^T r)
//
// (Woodbury's formula, diagonal in the basis V). Each kappa then costs two small products.
#pragma once

#include "rbvi/fem/problem.hpp"
#include "rbvi/solve/full_body.hpp"
#include "rbvi/solve/response_solver.hpp"

#include <memory>

namespace rbvi {

class ScaledPart : public FullBody {
public:
  /// Whether over the free parameters A = A_0 + theta(mu) A_1 of exact terms, theta > 0 and not the
  /// same at the two bounds of all of them, and nothing loads the body but contact.
  static bool fits(const Scene &scene);

  /// Factorisations at the bounds of theta, and n_c + 2 n_i solves or two complements
  /// (condensed_by_loads).
  /// `problem` must outlive it. Collective.
  explicit ScaledPart(const Problem &problem);
  /// A of the next calls, that of these operators. Not collective.
  void set(const Operators &op);

  Matrix moved(const SparseMatrix &b, const std::vector<Index> &which) override;
  Vector free(const Operators &) override { return Vector::Zero(size()); } ///< nothing loads it
  double displacement(const Operators &op, const Vector &lambda, Vec u) override;

private:
  void make(const std::vector<Index> &dofs, Eigen::Ref<Matrix> columns) override;
  void find_interface(const Problem &problem);

  const Problem &problem_;
  double lower_ = 0, width_ = 0;           ///< of the range of theta
  Trace contact_, interface_, both_;       ///< both_: contact dofs, then the interface
  std::unique_ptr<ResponseSolver> solver_; ///< at kappa_0, the lower bound
  Matrix compliance_;                      ///< G_cc
  Matrix w_, y_;
  Vector sigma_; ///< times the width of the range of theta

  Vector phi_; ///< at the current mu
};

} // namespace rbvi
