#include "cone_tools.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/par/small_svd.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace rbvi {

namespace {

constexpr double open_below = 1e-10; ///< of the largest multiplier: at or below it a node is open

/// The largest and the smallest singular value of a large triangle, to some percent.
Vector iterated_values(const Matrix &triangular) {
  constexpr int steps = 40;
  const auto upper = triangular.triangularView<Eigen::Upper>();
  const auto lower = triangular.transpose().triangularView<Eigen::Lower>();
  Vector large = Vector::Ones(triangular.cols()), small = large;
  Vector values(2);
  for (int k = 0; k < steps; ++k) {
    large = lower * (upper * large.normalized()).eval();
    small = upper.solve(lower.solve(small.normalized()).eval());
  }
  values << std::sqrt(large.norm()), 1 / std::sqrt(small.norm());
  return values;
}

/// From the triangular factor of the coordinates, not from the Gram matrix: squares would lose
/// half of the digits.
double condition(const Matrix &triangular) {
  constexpr Index large = 256;
  if (triangular.rows() < triangular.cols()) return std::numeric_limits<double>::infinity();
  const Vector values =
      triangular.cols() > large ? iterated_values(triangular) : singular_values(triangular);
  const double ratio = values[0] / values[values.size() - 1];
  return ratio * ratio;
}

} // namespace

ProductRoot::ProductRoot(const SparseMatrix &product) {
  factor_.compute(Eigen::SparseMatrix<double>(product));
  if (factor_.info() != Eigen::Success)
    throw failure("the inner product of the multipliers is not positive definite");
}

Matrix ProductRoot::times(const Matrix &x) const {
  return factor_.matrixU() * Matrix(factor_.permutationP() * x);
}

Matrix ProductRoot::solve(const Matrix &y) const {
  return factor_.permutationPinv() * Matrix(factor_.matrixU().solve(y));
}

SparseMatrix block_of(const SparseMatrix &product, const std::vector<Index> &nodes) {
  std::vector<Index> position(product.rows(), -1);
  for (std::size_t k = 0; k < nodes.size(); ++k)
    position[nodes[k]] = static_cast<Index>(k);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < nodes.size(); ++k)
    for (SparseMatrix::InnerIterator entry(product, nodes[k]); entry; ++entry)
      if (const Index column = position[entry.col()]; column >= 0)
        entries.emplace_back(static_cast<int>(k), static_cast<int>(column), entry.value());
  SparseMatrix block(std::ssize(nodes), std::ssize(nodes));
  block.setFromTriplets(entries.begin(), entries.end());
  return block;
}

Matrix checked(const Matrix &snapshots, const SparseMatrix &product) {
  if (snapshots.size() == 0) throw failure("no multiplier snapshot to build a cone from");
  if (product.rows() != snapshots.rows() || product.cols() != snapshots.rows())
    throw failure("the multiplier snapshots and their inner product differ in size");
  if (!snapshots.allFinite()) throw failure("a multiplier snapshot is not finite");
  const double largest = snapshots.cwiseAbs().maxCoeff();
  if (largest == 0)
    throw failure("all multiplier snapshots are zero: nothing is in contact in the training set");
  Index row = 0, column = 0;
  if (snapshots.minCoeff(&row, &column) < -1e-12 * largest)
    throw failure("multiplier snapshot " + std::to_string(column) +
                  " is negative: the high-fidelity solve is not converged");
  return snapshots.cwiseMax(0.0);
}

double gram_condition(const Matrix &coordinates) {
  return condition(triangular_factor(coordinates));
}

std::vector<double> gram_conditions(const Matrix &coordinates, Index smallest) {
  const Matrix triangular = triangular_factor(coordinates);
  std::vector<double> result;
  for (Index r = smallest; r <= coordinates.cols(); ++r)
    result.push_back(condition(triangular.topLeftCorner(std::min(r, triangular.rows()), r)));
  return result;
}

std::vector<bool> ever_in_contact(const Matrix &snapshots) {
  const double least = open_below * snapshots.maxCoeff();
  std::vector<bool> result;
  for (const double largest : Vector(snapshots.rowwise().maxCoeff()))
    result.push_back(largest > least);
  return result;
}

std::vector<bool> ever_open(const Matrix &snapshots) {
  const double open = open_below * snapshots.maxCoeff();
  std::vector<bool> result;
  for (const double least : Vector(snapshots.rowwise().minCoeff()))
    result.push_back(least <= open);
  return result;
}

void add_neighbours(std::vector<bool> &inside, const SparseMatrix &product) {
  const std::vector<bool> before = inside;
  for (Index i = 0; i < product.outerSize(); ++i)
    for (SparseMatrix::InnerIterator entry(product, i); entry; ++entry)
      if (before[i]) inside[entry.col()] = true;
}

Cone nodal_cone(const Matrix &snapshots, const SparseMatrix &product, const ConeOptions &options) {
  const Matrix factor = product_factor(product);
  std::vector<bool> inside = ever_in_contact(snapshots);
  for (int layer = 0; layer < options.ring; ++layer)
    add_neighbours(inside, product);

  std::vector<Index> nodes;
  Matrix outside = snapshots;
  for (Index i = 0; i < snapshots.rows(); ++i)
    if (inside[i]) {
      nodes.push_back(i);
      outside.row(i).setZero();
    }
  const auto count = std::ssize(nodes);
  Cone cone;
  cone.basis.generators = Matrix::Zero(snapshots.rows(), count);
  for (Index k = 0; k < count; ++k) {
    const Index i = nodes[k];
    cone.basis.generators(i, k) = 1 / factor.col(i).norm();
  }
  cone.history.size = {0, static_cast<int>(count)};
  // The snapshots without what is outside lie in the cone: a bound, 0 or next to it.
  const double left = (factor * outside).colwise().norm().maxCoeff();
  cone.history.error = {1, left / (factor * snapshots).colwise().norm().maxCoeff()};
  cone.history.gram_condition = {gram_condition(factor * cone.basis.generators)};
  cone.history.reason = "round-off reached";
  return cone;
}

} // namespace rbvi
