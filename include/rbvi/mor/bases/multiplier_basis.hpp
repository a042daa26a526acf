// Functions that the multipliers of contact with friction are combined from (Niakh 2022, 3.3.2, and
// two others), in coefficients of the nodal dual basis: m of them, k for lambda_n and the rest for
// lambda_tau, of the interfaces with friction alone. Serial and dense.
//
//   collocated   mCPG (or another cone) of lambda_n, POD of lambda_tau
//   cones        a cone of lambda_n, and one of what is left to the bound of friction
//   joint        POD of (lambda_n, lambda_tau) together, collocation nodes by pivoted QR
#pragma once

#include "rbvi/law/friction/friction.hpp"
#include "rbvi/mor/bases/cones.hpp"
#include "rbvi/rom/model/model.hpp"

namespace rbvi {

struct MultiplierOptions {
  MultiplierReduction reduction = MultiplierReduction::automatic;
  double tangential = 1e-4; ///< tolerance of POD: collocated of lambda_tau, joint of both
  int extra_nodes = 4;      ///< joint: collocation nodes beyond the number of modes
  bool exact = true;        ///< answers that break the law are mended on the condensed operator
};

struct MultiplierBases {
  MultiplierBasis basis;
  ConeHistory normal, left_to_bound; ///< of the cones
  std::vector<double> tangential;    ///< error of POD with 0, 1, ... modes, as (3.60c)
};

/// The functions of `basis` at all dual dofs, those of lambda_n first: dual dofs x (R + S).
/// `nodal`: the nodal dual basis, whose coefficients they are.
Matrix multiplier_functions(const Matrix &nodal, const MultiplierBasis &basis);

/// Modes of snapshots, orthonormal in `product`: as few as hold the tolerance.
struct DenseModes {
  Matrix columns;
  std::vector<double> error; ///< e(n), n = 0, 1, ..., rank: root of sum of squares, relative
};

/// QR, then SVD of the small factor. Throws failure where all snapshots are zero.
DenseModes dense_pod(const Matrix &snapshots, const SparseMatrix &product, double tolerance);

/// `coefficients`: m x P; `product`: m x m, its blocks of lambda_n and lambda_tau; `laws`: of each
/// snapshot. Without friction m = k: cones of lambda_n alone, and modes of it for joint.
/// Throws failure where the snapshots do not slip at all or, for cones, in two directions at one
/// node; bad_input for cones of type hybrid, which has functions of either sign.
MultiplierBases make_multiplier_basis(const Matrix &coefficients, const SparseMatrix &product,
                                      const std::vector<NodeLaws> &laws,
                                      const MultiplierOptions &options, const ConeOptions &cone);

} // namespace rbvi
