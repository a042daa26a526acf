#include "cone_tools.hpp"

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
