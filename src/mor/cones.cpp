#include "rbvi/mor/cones.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/nonnegative_qp.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <Eigen/SVD>

#include <algorithm>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

namespace rbvi {

namespace {

constexpr double tie = 1e-10;
constexpr double round_off = 1e-12; ///< of the largest snapshot: what is left below it is noise

/// The snapshots with round-off below zero removed.
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

/// Exact distances of the snapshots to a growing cone. They never increase, so an old one is a
/// bound: only those that can still be the largest are brought up to date.
class Distances {
public:
  /// `targets`: one column of coordinates per snapshot.
  explicit Distances(const Matrix &targets) : targets_(targets), value_(targets.colwise().norm()) {
    norm_ = value_;
    seen_.assign(static_cast<std::size_t>(targets.cols()), 0);
    qp_.assign(seen_.size(), NonnegativeQp(targets.rows()));
  }

  /// The largest distance and the lowest index at which it is reached within `tie`.
  std::pair<Index, double> largest(const Eigen::Ref<const Matrix> &generators) {
    std::vector<Index> order(seen_.size());
    for (Index p = 0; p < value_.size(); ++p)
      order[static_cast<std::size_t>(p)] = p;
    std::sort(order.begin(), order.end(), [&](Index a, Index b) { return value_[a] > value_[b]; });
    double best = 0;
    std::size_t fresh = 0;
    for (; fresh < order.size() && value_[order[fresh]] >= (1 - tie) * best; ++fresh)
      best = std::max(best, update(order[fresh], generators));
    Index index = value_.size();
    for (std::size_t k = 0; k < fresh; ++k)
      if (value_[order[k]] >= (1 - tie) * best) index = std::min(index, order[k]);
    return {index, best};
  }

  double update(Index p, const Eigen::Ref<const Matrix> &generators) {
    auto &seen = seen_[static_cast<std::size_t>(p)];
    auto &qp = qp_[static_cast<std::size_t>(p)];
    const Index fresh = generators.cols() - seen;
    const auto residual = [&] { return seen == 0 ? Vector(targets_.col(p)) : qp.residual(); };
    // A generator that makes no acute angle with the residual leaves the projection as it is.
    const bool improves =
        fresh > 0 &&
        (generators.rightCols(fresh).transpose() * residual()).maxCoeff() > 1e-13 * norm_[p];
    if (!improves) return value_[p];
    if (!qp.solve(generators, targets_.col(p)).converged)
      throw failure("the projection of multiplier snapshot " + std::to_string(p) +
                    " onto the cone did not converge; try a larger -cone_tolerance");
    seen = generators.cols();
    value_[p] = std::min(value_[p], qp.residual().norm());
    return value_[p];
  }

private:
  const Matrix &targets_;
  Vector value_, norm_;
  std::vector<Index> seen_; ///< generators at the last solve
  std::vector<NonnegativeQp> qp_;
};

/// T with |T v| = |v|_W for every v that the greedy meets: the span of the snapshots has far fewer
/// dimensions than nodes, and clipping alone leaves it.
Matrix coordinate_map(const Matrix &snapshots, const SparseMatrix &product,
                      const ConeOptions &options) {
  const Matrix factor = product_factor(product);
  const bool clips = options.type == ConeType::mcpg && options.feasibility > 0;
  if (clips || snapshots.cols() >= snapshots.rows()) return factor;
  const Eigen::HouseholderQR<Matrix> qr(factor * snapshots);
  const Matrix span = qr.householderQ() * Matrix::Identity(snapshots.rows(), snapshots.cols());
  return span.transpose() * factor;
}

/// Lines 9 and 10 of Algorithm 2 up to the norm. What round-off left of an exact contact with the
/// bound is made zero, or it would forbid this generator below later snapshots.
Vector remainder(const Vector &theta, const Matrix &generators, const Matrix &coordinates,
                 const Vector &target, const ConeOptions &options) {
  if (options.type == ConeType::cpg || generators.cols() == 0) return theta;
  const double largest = theta.maxCoeff();
  const PartBelow part =
      largest_part_below(theta, options.feasibility * largest, generators, coordinates, target);
  Vector left = theta - generators * part.coefficients;
  left(part.touching).setZero();
  return (left.array() > 1e-13 * largest).select(left, 0.0);
}

/// Condition numbers of the Gram matrices of the leading columns, from singular values.
std::vector<double> gram_conditions(const Matrix &coordinates) {
  const Index count = std::min(coordinates.rows(), coordinates.cols());
  const Eigen::HouseholderQR<Matrix> qr(coordinates);
  std::vector<double> result;
  for (Index r = 1; r <= coordinates.cols(); ++r) {
    const Index rows = std::min(r, count);
    const Matrix leading = qr.matrixQR().topLeftCorner(rows, r).triangularView<Eigen::Upper>();
    const Vector values = Eigen::BDCSVD<Matrix>(leading).singularValues();
    const double ratio = values[0] / values[rows - 1];
    result.push_back(rows < r ? std::numeric_limits<double>::infinity() : ratio * ratio);
  }
  return result;
}

} // namespace

Matrix product_factor(const SparseMatrix &product) {
  const Eigen::LLT<Matrix> cholesky{Matrix(product)};
  if (cholesky.info() != Eigen::Success)
    throw failure("the inner product of the multipliers is not positive definite");
  return cholesky.matrixU();
}

Cone build_cone(const Matrix &snapshots, const SparseMatrix &product, const ConeOptions &options) {
  const Matrix thetas = checked(snapshots, product);
  const Matrix map = coordinate_map(thetas, product, options);
  const Matrix targets = map * thetas;
  Distances distances(targets);
  const Index bound =
      options.max_size > 0 ? std::min<Index>(options.max_size, thetas.cols()) : thetas.cols();
  Matrix generators(thetas.rows(), bound), coordinates(map.rows(), bound);
  Cone cone;
  ConeHistory &history = cone.history;
  auto [selected, distance] = distances.largest(coordinates.leftCols(0));
  const double scale = distance;
  history.error.push_back(1);
  Index r = 0;
  while (history.reason.empty()) {
    if (r > 0 && history.error.back() <= options.tolerance)
      history.reason = "tolerance reached";
    else if (history.error.back() <= round_off)
      history.reason = "round-off reached";
    else if (r == bound)
      history.reason = "size reached";
    if (!history.reason.empty()) break;

    const Vector left = remainder(thetas.col(selected), generators.leftCols(r),
                                  coordinates.leftCols(r), targets.col(selected), options);
    const Vector image = map * left;
    if (!(image.norm() > 0)) {
      history.reason = "stagnation";
      break;
    }
    generators.col(r) = left / image.norm();
    coordinates.col(r) = image / image.norm();
    NonnegativeQp projection(map.rows());
    if (!projection.solve(coordinates.leftCols(r), coordinates.col(r)).converged)
      throw failure("the projection of generator " + std::to_string(r) + " did not converge");
    history.e_orth.push_back(projection.residual().norm());
    history.selected.push_back(static_cast<int>(selected));
    ++r;
    const double closer = distances.update(selected, coordinates.leftCols(r));
    if (closer > 0.99 * distance) history.reason = "stagnation";
    std::tie(selected, distance) = distances.largest(coordinates.leftCols(r));
    history.error.push_back(distance / scale);
  }
  cone.basis.generators = generators.leftCols(r);
  history.gram_condition = gram_conditions(coordinates.leftCols(r));
  return cone;
}

Vector distances_to_cone(const Matrix &values, const ConeBasis &basis,
                         const SparseMatrix &product) {
  const Matrix factor = product_factor(product);
  const Matrix targets = factor * values, coordinates = factor * basis.generators;
  Vector result = targets.colwise().norm();
  const double scale = result.maxCoeff();
  if (scale == 0) return result;
  NonnegativeQp projection(factor.rows());
  for (Index p = 0; p < values.cols(); ++p) {
    if (!projection.solve(coordinates, targets.col(p)).converged)
      throw failure("the projection of a multiplier onto the cone did not converge");
    result[p] = projection.residual().norm();
  }
  return result / scale;
}

} // namespace rbvi
