// beta_HF and c_HF (2.3) of pairs with too many multipliers for dense matrices of them.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/fem/trace.hpp"

#include <vector>

namespace rbvi {

/// Inf-sup constants over all multipliers: beta^2 is the smallest eigenvalue of
/// B V^-1 B^T x = beta^2 W x, by SLEPc's EPS (prefix infsup_) on the inverse, R^T (B V^-1 B^T)^-1 R
/// with W = R R^T: y of
///   [ V  B^T ] [ u ]   [  0  ]
///   [ B  0   ] [ y ] = [ R x ]
/// is -(B V^-1 B^T)^-1 R x. Unshifted, the condition number grows fourfold with each refinement.
class SparseInfSup {
public:
  /// Collective. `product`: V, whole on every rank from here on; `trace`: of the contact dofs.
  SparseInfSup(Mat product, const Trace &trace);

  /// Serial: one factorisation of the matrix above, by MUMPS. `b_contact`: dual x contact dofs,
  /// `w_product`: of the same multipliers. 0 where there are more multipliers than contact dofs.
  /// Throws failure if rows of b depend on each other, or if the iteration does not converge.
  double constant(const SparseMatrix &b_contact, const SparseMatrix &w_product) const;

private:
  Handle<Mat> product_;
  std::vector<PetscInt> dofs_; ///< row of each contact dof in it
};

/// The largest |b(v, eta)| over |v| |eta| = 1: c^2 is the largest eigenvalue of R^-1 B V^-1 B^T
/// R^-T, by the same EPS. `riesz_factor`: L of E^T V^-1 E = L L^T on the contact dofs, n_c x n_c;
/// `b_contact`: dual x n_c. Serial. Throws failure if the iteration does not converge.
double largest_stretch(const Matrix &riesz_factor, const SparseMatrix &b_contact,
                       const SparseMatrix &w_product);

/// The EPS of both for an operator of `size` rows, its options read. Throws failure for a value
/// that SLEPc refuses.
Handle<EPS> make_infsup_eps(PetscInt size = 64);

} // namespace rbvi
