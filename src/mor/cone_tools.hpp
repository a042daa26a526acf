// What the types of dual basis share, and the type that has a file of its own each.
#pragma once

#include "rbvi/mor/cones.hpp"

#include <Eigen/SparseCholesky>

#include <vector>

namespace rbvi {

/// U with |U v| = |v|_W: a sparse Cholesky factor, its rows in an order of its own.
class ProductRoot {
public:
  /// Throws failure if `product` is not positive definite.
  explicit ProductRoot(const SparseMatrix &product);
  Matrix times(const Matrix &x) const; ///< U x
  Matrix solve(const Matrix &y) const; ///< U^-1 y

private:
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor_;
};

/// Rows and columns of some nodes.
SparseMatrix block_of(const SparseMatrix &product, const std::vector<Index> &nodes);

constexpr double round_off = 1e-12; ///< of the largest snapshot: what is left below it is noise

/// The snapshots with round-off below zero removed. Throws failure as build_cone does, but for a
/// `product` that is not positive definite.
Matrix checked(const Matrix &snapshots, const SparseMatrix &product);

/// Condition number of the Gram matrix of generators with these coordinates (orthonormal axes);
/// infinite if there are more of them than coordinates.
double gram_condition(const Matrix &coordinates);

/// Condition numbers of the Gram matrices of the first `smallest`, smallest + 1, ... columns.
std::vector<double> gram_conditions(const Matrix &coordinates, Index smallest = 1);

/// Per node: whether some multiplier is positive there; whether some is zero.
std::vector<bool> ever_in_contact(const Matrix &snapshots);
std::vector<bool> ever_open(const Matrix &snapshots);

/// Adds the nodes that `product` couples with one that is in the set.
void add_neighbours(std::vector<bool> &inside, const SparseMatrix &product);

// Types: `snapshots` are checked ones.
Cone nodal_cone(const Matrix &snapshots, const SparseMatrix &product, const ConeOptions &options);
Cone hybrid_cone(const Matrix &snapshots, const SparseMatrix &product, const ConeOptions &options,
                 const HoldingMultipliers &hold);

/// Whether products are cheaper without the zeros.
inline bool mostly_zero(const Eigen::Ref<const Matrix> &matrix) {
  constexpr Index one_in = 10;
  return one_in * (matrix.array() != 0).count() < matrix.size();
}

} // namespace rbvi
