// Positive cones for multipliers: CPG (B.2) and modified CPG (Algorithm 2), Niakh (2022). Serial
// and dense: the multipliers live on the contact region alone, every rank holds them all.
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
  std::vector<double> error;  ///< e(r), r = 0, 1, ..., R, over all snapshots: (2.13), (2.34)
  std::vector<double> e_orth; ///< distance of generator r + 1 to the cone of the first r (2.41)
  std::vector<double> gram_condition; ///< condition number of the Gram matrix of the first r >= 1;
                                      ///< infinite if they are dependent
  std::vector<int> selected;          ///< snapshot taken at each step
  std::string reason; ///< "tolerance reached", "round-off reached", "size reached", "stagnation"
};

struct Cone {
  ConeBasis basis;
  ConeHistory history;
};

enum class ConeType { cpg, mcpg };

struct ConeOptions {
  ConeType type = ConeType::mcpg;
  double tolerance = 1e-2; ///< stop when the error (2.34) is at or below
  int max_size = 0;        ///< 0: no bound but the number of snapshots
  double feasibility = 0;  ///< line 9: theta - Upsilon >= -feasibility * max theta; 0 is strict
};

/// `snapshots`: dual dofs x P, entries >= 0; `product`: Gram matrix of W, symmetric positive
/// definite. Ties within 1e-10 relative go to the lowest index. With feasibility > 0 negative
/// remainders are clipped, a snapshot taken can stay outside the cone and be taken again; the
/// greedy stops when a step does not bring its own snapshot closer. Throws failure if `snapshots`
/// is empty, all zero, not finite or has a negative entry beyond round-off, or if `product` does
/// not fit or is not positive definite.
Cone build_cone(const Matrix &snapshots, const SparseMatrix &product, const ConeOptions &options);

/// Relative distance of each column of `values` to the cone: |v - Pi v|_W / max_p |v_p|_W (all
/// zero if every column is).
Vector distances_to_cone(const Matrix &values, const ConeBasis &basis, const SparseMatrix &product);

/// U with U^T U = `product`: |U v| = |v|_W. Throws failure if it is not positive definite.
Matrix product_factor(const SparseMatrix &product);

/// Largest part of theta that a cone represents from below.
struct PartBelow {
  Vector coefficients;         ///< a >= 0, one per generator
  std::vector<Index> touching; ///< nodes where the bound is active
};

/// Line 9 of Algorithm 2: a >= 0 that minimises |theta - N a|_W under theta - N a >= -slack at
/// every node; N = `generators`, `coordinates` = U N, `target` = U theta with |U .| the norm of W.
/// Where theta + slack is zero no generator that is positive may take part. Exact, by the dual of
/// a least-distance problem. Throws failure if that does not converge.
PartBelow largest_part_below(const Vector &theta, double slack, const Matrix &generators,
                             const Matrix &coordinates, const Vector &target);

} // namespace rbvi
