// Greedy collocation node selection (Niakh 2022, Algorithm 3): the nodes at which the reduced model
// holds the bound of friction. Every reduced problem is solved exactly. Serial and dense.
#pragma once

#include "rbvi/method/published/collocated_friction.hpp"
#include "rbvi/mor/collocation.hpp"

namespace rbvi {

/// The reduced problem at one training mu, without its collocation rows, and the truth.
struct GcnsSample {
  Matrix h;
  Vector q;
  std::vector<FrictionBound> bounds; ///< of each node; a single one: of all
  Vector tangential;                 ///< lambda_tau, high-fidelity, at all nodes
};

/// `normal_basis`: nodes x R, `tangential_basis`: nodes x S, values at all nodes; `product`: Gram
/// matrix of the tangential multipliers (nodes x nodes). Starts without nodes; a step adds all
/// nodes where the violation at mu_q is largest (ties within 1e-10 relative: both of a mirrored
/// pair), and ends when no bound is violated any more. Goes on to all nodes where no tolerance
/// and no rise of the error stops it, and then returns the nodes of the least error. A sample
/// without tangential multipliers counts with its absolute error, relative to the largest of the
/// others. A reduced problem that is not solved ends the selection (`reason` says so); throws
/// failure if it is one of the first step, for sizes that do not fit, or without samples or
/// tangential multipliers.
Gcns select_collocation_nodes(const std::vector<GcnsSample> &samples, const Matrix &normal_basis,
                              const Matrix &tangential_basis, const SparseMatrix &product,
                              const GcnsOptions &options);

} // namespace rbvi
