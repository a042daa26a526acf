// A basis that a greedy builds from snapshots, and distances to it.
#pragma once

#include "../cone_tools.hpp"
#include "rbvi/method/nonnegative_qp.hpp"

#include <utility>

namespace rbvi {

constexpr double tie = 1e-10;

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

} // namespace rbvi
