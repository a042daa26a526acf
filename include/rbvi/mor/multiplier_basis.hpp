// Functions that the multipliers of contact with friction are combined from (Niakh 2022, 3.3.2), in
// coefficients of the nodal dual basis: m of them, k for lambda_n and the rest for lambda_tau, of
// the interfaces with friction alone. Serial and dense. Niakh (2022): (3.36)-(3.38).
#pragma once

#include "rbvi/model/model.hpp"
#include "rbvi/mor/cones.hpp"

namespace rbvi {

struct MultiplierOptions {
  MultiplierReduction reduction = MultiplierReduction::automatic;
  double tangential = 1e-4; ///< collocated: tolerance of POD of lambda_tau
  bool exact = true;        ///< collocated: NodalLaw::mended
};

struct MultiplierBases {
  MultiplierBasis basis;
  ConeHistory normal;
  std::vector<double> tangential; ///< error of POD with 0, 1, ... modes, as (3.60c)
};

/// The functions of `basis` at all dual dofs, those of lambda_n first: dual dofs x (R + S).
/// `nodal`: the nodal dual basis, whose coefficients they are.
Matrix multiplier_functions(const Matrix &nodal, const MultiplierBasis &basis);

/// A cone of lambda_n and, with friction, modes of lambda_tau: as few as leave `tangential`.
/// `coefficients`: m x P, `normal` rows of lambda_n first; without friction they are all.
/// `product`: m x m, its blocks of lambda_n and lambda_tau. Throws failure where the snapshots have
/// no tangential stress at all.
MultiplierBases make_multiplier_basis(const Matrix &coefficients, Index normal,
                                      const SparseMatrix &product, double tangential,
                                      const ConeOptions &cone);

} // namespace rbvi
