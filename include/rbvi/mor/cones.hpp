// Dual bases: what multipliers are combined from (Niakh 2022, 2.2.2, 2.4). Serial and dense: the
// multipliers live on the contact region alone, every rank holds them all.
//
//   cpg, mcpg      cone-projected greedy (B.2) and its modification (Algorithm 2)
//   angle_greedy   the snapshot that makes the largest angle with the span of those taken
//                  (Haasdonk, Salomon and Wohlmuth, SIAM J. Numer. Anal. 50, 2012)
//   nmf            non-negative factorisation of the snapshot matrix (Lee and Seung, NIPS 2000)
//   nodal          the hat functions that were ever active in training, and a ring around them
//   hybrid         on the nodes over which the edge of contact moves: hat functions, extended to
//                  the nodes that never leave contact so that they do not move those; there: a few
//                  modes of either sign
// Niakh (2022): (2.12).
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/variants.hpp"
#include "rbvi/mor/held_multipliers.hpp"

#include <string>
#include <vector>

namespace rbvi {

/// Generators with coefficients >= 0, of unit norm in W. Nodal values are >= 0 where there are no
/// FreeModes beside it. Never orthonormalised: that would leave W+ (linear bases are another type,
/// LinearBasis in mor/pod.hpp).
struct ConeBasis {
  Matrix generators; ///< dual dofs x cone generators
};

/// Multipliers with coefficients of either sign, orthonormal in W: on nodes in permanent contact
/// the constraint is an equation and no sign is decided.
struct FreeModes {
  Matrix columns; ///< dual dofs x modes
};

struct ConeHistory {
  std::vector<int> size;      ///< generators (and modes) at each error: 0, 1, ..., R for a greedy
  std::vector<double> error;  ///< over all snapshots, (2.13), (2.34): 1 for no generator
  std::vector<double> e_orth; ///< greedy types: distance of generator r + 1 to the cone of the
                              ///< first r (2.41)
  std::vector<double> gram_condition; ///< condition number of the Gram matrix of the generators at
                                      ///< each size but the first; infinite if they are dependent
  std::vector<int> selected;          ///< greedy types: snapshot taken at each step
  std::string reason; ///< "tolerance reached", "round-off reached", "size reached", "stagnation"
};

struct Cone {
  ConeBasis basis;
  FreeModes modes; ///< none but for hybrid
  ConeHistory history;
  Index size() const { return basis.generators.cols() + modes.columns.cols(); }
  Matrix all() const; ///< [generators, modes]: dual dofs x size()
};

enum class ConeType { cpg, mcpg, angle_greedy, nmf, nodal, hybrid };

/// "cpg", "mcpg", ..., in the order of ConeType.
const std::vector<std::string> &cone_type_names();

struct ConeOptions {
  ConeType type = ConeType::hybrid;
  double tolerance = 1e-4; ///< stop when the error (2.34) is at or below; nodal: not used
  int max_size = 0;        ///< 0: no bound but the number of snapshots; nodal: not used
  double feasibility = 0;  ///< mcpg, line 9: theta - Upsilon >= -feasibility * max theta
  int ring = 1;            ///< nodal, hybrid: layers of neighbours on either side of moving contact
  /// Hat functions of the mesh with so many refinements less in place of those of nodes: hybrid,
  /// and in place of the nodes where the law of contact is kept at them.
  int level = 0;
  SparseMatrix hats{}; ///< hybrid: those of `level` (hats_of_level); dual dofs x any number
};

/// `snapshots`: dual dofs x P, entries >= 0; `product`: Gram matrix of W, symmetric positive
/// definite, with an entry for every pair of neighbouring nodes. Ties within 1e-10 relative go to
/// the lowest index. With feasibility > 0 negative remainders are clipped, a snapshot taken can
/// stay outside the cone and be taken again; the greedy stops when a step does not bring its own
/// snapshot closer. `hold` (hybrid alone): of A and B at one mu (holding). Throws failure if
/// `snapshots` is empty, all zero, not finite or has a negative entry beyond round-off, or if
/// `product` does not fit or is not positive definite.
Cone build_cone(const Matrix &snapshots, const SparseMatrix &product, const ConeOptions &options,
                const HoldingMultipliers &hold = {});

using ConeMaker = Cone (*)(const Matrix &snapshots, const SparseMatrix &product,
                           const ConeOptions &options);
/// Types beside nodal and hybrid: their snapshots are those of build_cone, without round-off below
/// zero.
std::map<ConeType, ConeMaker> &cone_makers();

/// Relative distance of each column of `values` to what the cone and the modes span:
/// |v - Pi v|_W / max_p |v_p|_W (all zero if every column is).
Vector distances_to_cone(const Matrix &values, const ConeBasis &basis, const SparseMatrix &product,
                         const FreeModes &modes = {});

/// U with U^T U = `product`: |U v| = |v|_W. Throws failure if it is not positive definite.
Matrix product_factor(const SparseMatrix &product);

} // namespace rbvi
