#include "greedy_cone.hpp"

#include "rbvi/core/error.hpp"
#include "reductions.hpp"

#include <algorithm>
#include <string>
#include <tuple>

namespace rbvi {

namespace {

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
    throw failure("the projection of function " + std::to_string(size_) + " did not converge");
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
