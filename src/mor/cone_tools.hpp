// What the types of dual basis share, and the type that has a file of its own each.
#pragma once

#include "rbvi/method/nonnegative_qp.hpp"
#include "rbvi/mor/cones.hpp"

#include <Eigen/SparseCholesky>

#include <utility>
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

constexpr double tie = 1e-10;
constexpr double round_off = 1e-12; ///< of the largest snapshot: what is left below it is noise

/// The snapshots with round-off below zero removed. Throws failure as build_cone does, but for a
/// `product` that is not positive definite.
Matrix checked(const Matrix &snapshots, const SparseMatrix &product);

/// Condition number of the Gram matrix of generators with these coordinates (orthonormal axes);
/// infinite if there are more of them than coordinates.
double gram_condition(const Matrix &coordinates);

/// Condition numbers of the Gram matrices of the first `smallest`, smallest + 1, ... columns.
std::vector<double> gram_conditions(const Matrix &coordinates, Index smallest = 1);

/// Exact distances of the snapshots to a growing cone. They never increase, so an old one is a
/// bound: only those that can still be the largest are brought up to date.
class Distances {
public:
  /// `targets`: one column of coordinates per snapshot; must outlive this.
  explicit Distances(const Matrix &targets);
  /// Starts from coefficients >= 0 of every snapshot in the first generators, which bound its
  /// distance: generators x snapshots.
  Distances(const Matrix &targets, const Matrix &coordinates, const Matrix &coefficients);
  /// The largest distance and the lowest index at which it is reached within `tie`.
  std::pair<Index, double> largest(const Eigen::Ref<const Matrix> &coordinates);
  /// Distance of snapshot p, brought up to date.
  double update(Index p, const Eigen::Ref<const Matrix> &coordinates);

private:
  const Matrix &targets_;
  Vector value_, norm_;
  std::vector<Index> seen_; ///< generators at the last solve
  std::vector<NonnegativeQp> qp_;
};

/// T with |T v| = |v|_W for every v in the span of the snapshots, which often has far fewer
/// dimensions than there are nodes.
Matrix span_coordinates(const Matrix &snapshots, const SparseMatrix &product);

/// A basis that a greedy builds from snapshots, with its history.
class GreedyCone {
public:
  /// `map`: |map * v| = |v|_W for all snapshots and generators.
  GreedyCone(const Matrix &snapshots, Matrix map, const ConeOptions &options);
  GreedyCone(const GreedyCone &) = delete;
  GreedyCone &operator=(const GreedyCone &) = delete;

  Index size() const { return size_; }
  auto generators() const { return generators_.leftCols(size_); }
  auto coordinates() const { return coordinates_.leftCols(size_); }
  const Matrix &targets() const { return targets_; } ///< coordinates of the snapshots
  Index farthest() const { return farthest_; }       ///< snapshot, lowest index of a tie
  double distance() const { return distance_; }      ///< of that snapshot
  /// Whether to stop: at the tolerance, at round-off, at the largest size, or stagnated.
  bool finished();
  void stagnate() { cone_.history.reason = "stagnation"; }
  /// Takes `direction`, made from this snapshot; stagnates if it is zero or does not bring the
  /// snapshot closer. Throws failure if a projection does not converge.
  void add(const Vector &direction, Index snapshot);
  /// The basis; nothing can be added afterwards.
  Cone take();

private:
  Matrix map_, targets_, generators_, coordinates_;
  Distances distances_;
  double tolerance_;
  Cone cone_;
  Index size_ = 0, farthest_ = 0;
  double distance_ = 0, scale_ = 0;
};

/// Per node: whether some multiplier is positive there; whether some is zero.
std::vector<bool> ever_in_contact(const Matrix &snapshots);
std::vector<bool> ever_open(const Matrix &snapshots);

/// Adds the nodes that `product` couples with one that is in the set.
void add_neighbours(std::vector<bool> &inside, const SparseMatrix &product);

// The types: `snapshots` are checked ones.
Cone projected_greedy_cone(const Matrix &snapshots, const SparseMatrix &product,
                           const ConeOptions &options);
Cone angle_greedy_cone(const Matrix &snapshots, const SparseMatrix &product,
                       const ConeOptions &options);
Cone nmf_cone(const Matrix &snapshots, const SparseMatrix &product, const ConeOptions &options);
Cone nodal_cone(const Matrix &snapshots, const SparseMatrix &product, const ConeOptions &options);
Cone hybrid_cone(const Matrix &snapshots, const SparseMatrix &product, const ConeOptions &options,
                 const HoldingMultipliers &hold);

/// Whether products are cheaper without the zeros.
inline bool mostly_zero(const Eigen::Ref<const Matrix> &matrix) {
  constexpr Index one_in = 10;
  return one_in * (matrix.array() != 0).count() < matrix.size();
}

} // namespace rbvi
