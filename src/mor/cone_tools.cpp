#include "cone_tools.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/par/small_svd.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>

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

/// Parts of unit vectors that are orthogonal to the vectors taken: their norms are the sines of
/// the angles with the span of those.
class Angles {
public:
  /// Columns within round-off of zero have no direction: their parts are zero.
  explicit Angles(const Matrix &targets) : parts_(targets), taken_(targets.rows(), 0) {
    const Vector norms = targets.colwise().norm();
    for (Index p = 0; p < targets.cols(); ++p)
      parts_.col(p) *= norms[p] > round_off * norms.maxCoeff() ? 1 / norms[p] : 0.0;
  }

  /// The vector with the largest angle, lowest index of a tie, and its sine.
  std::pair<Index, double> largest() const {
    const Vector sines = parts_.colwise().norm();
    const double best = sines.maxCoeff();
    Index index = 0;
    while (sines[index] < (1 - tie) * best)
      ++index;
    return {index, best};
  }

  void take(Index p) {
    Vector axis = parts_.col(p).normalized();
    axis -= taken_ * (taken_.transpose() * axis); // again: the part may be a small remainder
    axis.normalize();
    parts_ -= axis * (axis.transpose() * parts_).eval();
    parts_.col(p).setZero();
    taken_.conservativeResize(Eigen::NoChange, taken_.cols() + 1);
    taken_.rightCols<1>() = axis;
  }

private:
  Matrix parts_, taken_;
};

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

Distances::Distances(const Matrix &targets)
    : targets_(targets), value_(targets.colwise().norm()), norm_(value_), seen_(targets.cols(), 0),
      qp_(seen_.size(), NonnegativeQp(targets.rows())) {}

Distances::Distances(const Matrix &targets, const Matrix &coordinates, const Matrix &coefficients)
    : Distances(targets) {
  value_ = (targets - coordinates * coefficients).colwise().norm();
  for (Index p = 0; p < targets.cols(); ++p) {
    std::vector<Index> active;
    for (Index k = 0; k < coefficients.rows(); ++k)
      if (coefficients(k, p) > 0) active.push_back(k);
    qp_[p].start_from(std::move(active));
  }
}

std::pair<Index, double> Distances::largest(const Eigen::Ref<const Matrix> &coordinates) {
  std::vector<Index> order(seen_.size());
  for (Index p = 0; p < value_.size(); ++p)
    order[p] = p;
  std::sort(order.begin(), order.end(), [&](Index a, Index b) { return value_[a] > value_[b]; });
  double best = 0;
  std::size_t fresh = 0;
  for (; fresh < order.size() && value_[order[fresh]] >= (1 - tie) * best; ++fresh)
    best = std::max(best, update(order[fresh], coordinates));
  Index index = value_.size();
  for (std::size_t k = 0; k < fresh; ++k)
    if (value_[order[k]] >= (1 - tie) * best) index = std::min(index, order[k]);
  return {index, best};
}

double Distances::update(Index p, const Eigen::Ref<const Matrix> &coordinates) {
  auto &seen = seen_[p];
  auto &qp = qp_[p];
  const Index fresh = coordinates.cols() - seen;
  const auto residual = [&] { return seen == 0 ? Vector(targets_.col(p)) : qp.residual(); };
  // A generator that makes no acute angle with the residual leaves the projection as it is.
  const bool improves =
      fresh > 0 &&
      (coordinates.rightCols(fresh).transpose() * residual()).maxCoeff() > 1e-13 * norm_[p];
  if (!improves) return value_[p];
  if (!qp.solve(coordinates, targets_.col(p)).converged)
    throw failure("the projection of multiplier snapshot " + std::to_string(p) +
                  " onto the cone did not converge; try a larger -cone_tolerance");
  seen = coordinates.cols();
  value_[p] = std::min(value_[p], qp.residual().norm());
  return value_[p];
}

Matrix span_coordinates(const Matrix &snapshots, const SparseMatrix &product) {
  const Matrix factor = product_factor(product);
  if (snapshots.cols() >= snapshots.rows()) return factor;
  return thin_qr(factor * snapshots).q.transpose() * factor;
}

GreedyCone::GreedyCone(const Matrix &snapshots, Matrix map, const ConeOptions &options)
    : map_(std::move(map)), targets_(map_ * snapshots), distances_(targets_),
      tolerance_(options.tolerance) {
  const Index bound =
      options.max_size > 0 ? std::min<Index>(options.max_size, snapshots.cols()) : snapshots.cols();
  generators_.resize(snapshots.rows(), bound);
  coordinates_.resize(map_.rows(), bound);
  std::tie(farthest_, distance_) = distances_.largest(coordinates());
  scale_ = distance_;
  cone_.history.size.push_back(0);
  cone_.history.error.push_back(1);
}

bool GreedyCone::finished() {
  ConeHistory &history = cone_.history;
  if (!history.reason.empty()) return true;
  if (size_ > 0 && history.error.back() <= tolerance_)
    history.reason = "tolerance reached";
  else if (history.error.back() <= round_off)
    history.reason = "round-off reached";
  else if (size_ == generators_.cols())
    history.reason = "size reached";
  return !history.reason.empty();
}

void GreedyCone::add(const Vector &direction, Index snapshot) {
  const Vector image = map_ * direction;
  if (!(image.norm() > 0)) return stagnate();
  generators_.col(size_) = direction / image.norm();
  coordinates_.col(size_) = image / image.norm();
  NonnegativeQp projection(map_.rows());
  if (!projection.solve(coordinates(), coordinates_.col(size_)).converged)
    throw failure("the projection of generator " + std::to_string(size_) + " did not converge");
  cone_.history.e_orth.push_back(projection.residual().norm());
  cone_.history.selected.push_back(static_cast<int>(snapshot));
  ++size_;
  if (snapshot == farthest_ && distances_.update(snapshot, coordinates()) > 0.99 * distance_)
    stagnate();
  std::tie(farthest_, distance_) = distances_.largest(coordinates());
  cone_.history.size.push_back(static_cast<int>(size_));
  cone_.history.error.push_back(distance_ / scale_);
}

Cone GreedyCone::take() {
  cone_.basis.generators = generators();
  cone_.history.gram_condition = gram_conditions(coordinates());
  return std::move(cone_);
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

Cone angle_greedy_cone(const Matrix &snapshots, const SparseMatrix &product,
                       const ConeOptions &options) {
  GreedyCone cone(snapshots, span_coordinates(snapshots, product), options);
  Angles angles(cone.targets());
  while (!cone.finished()) {
    // All angles with nothing are right: the first is the snapshot of largest norm.
    const auto [widest, sine] = angles.largest();
    const Index selected = cone.size() == 0 ? cone.farthest() : widest;
    if (sine <= round_off) {
      cone.stagnate();
      break;
    }
    cone.add(snapshots.col(selected), selected);
    angles.take(selected);
  }
  return cone.take();
}

} // namespace rbvi
