// Positive cones for multipliers: CPG (B.2) and modified CPG (Algorithm 2). Serial and dense: the
// multipliers live on the contact region alone, every rank holds them all.
#pragma once

#include "rbvi/core/dense.hpp"

#include <string>
#include <vector>

namespace rbvi {

/// Generators of a cone in W+: nodal values >= 0, of unit norm in W. Never orthonormalised: that
/// would leave W+ (linear bases are another type, LinearBasis in mor/pod.hpp).
struct ConeBasis {
  Matrix generators; ///< dual dofs x R
};

struct ConeHistory {
  std::vector<double> error;     ///< e(r), r = 0, 1, ..., over all snapshots: (2.13), (2.34)
  std::vector<double> e_orth;    ///< distance of generator r + 1 to the cone of the first r (2.41)
  std::vector<double> gram_condition; ///< condition number of the Gram matrix of the first r >= 1
  std::vector<int> selected;     ///< snapshot taken at each step
  std::string reason;            ///< "tolerance reached", "stagnation", "all snapshots taken", ...
};

struct Cone {
  ConeBasis basis;
  ConeHistory history;
};

enum class ConeType { cpg, mcpg };

struct ConeOptions {
  ConeType type = ConeType::mcpg;
  double tolerance = 1e-2;   ///< stop when the error (2.34) is at or below
  int max_size = 0;          ///< 0: no bound
  double feasibility = 0;    ///< line 9: theta - Upsilon >= -feasibility * max theta; 0 is strict
};

/// `snapshots`: dual dofs x P, entries >= 0; `product`: Gram matrix of W, symmetric positive
/// definite. Ties within 1e-10 relative go to the lowest index. Throws failure if `snapshots` is
/// empty, all zero or has a negative entry beyond round-off.
Cone build_cone(const Matrix &snapshots, const SparseMatrix &product, const ConeOptions &options);

/// Relative distance of each column of `values` to the cone: |v - Pi v|_W / max_p |v_p|_W.
Vector distances_to_cone(const Matrix &values, const ConeBasis &basis, const SparseMatrix &product);

} // namespace rbvi
