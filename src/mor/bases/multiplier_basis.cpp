#include "rbvi/mor/bases/multiplier_basis.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/law/friction/least_squares_friction.hpp"
#include "rbvi/par/small_svd.hpp"
#include "rbvi/rom/law/reduced_law.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

SparseMatrix block(const SparseMatrix &product, Index first, Index count) {
  return product.block(first, first, count, count);
}

/// s(lambda_n) - |lambda_tau| of each snapshot; round-off below zero removed.
Matrix left_to_bound(const Matrix &coefficients, const Matrix &tangential,
                     const std::vector<NodeLaws> &laws) {
  const std::vector<Index> nodes = nodes_with_tangent(laws.front());
  Matrix left(tangential.rows(), tangential.cols());
  for (Index p = 0; p < left.cols(); ++p) {
    const Vector bounds = bounds_of(laws[static_cast<std::size_t>(p)], coefficients.col(p));
    left.col(p) = (bounds(nodes) - tangential.col(p).cwiseAbs()).cwiseMax(0);
  }
  const double largest = left.maxCoeff();
  return (left.array() > 1e-12 * largest).select(left, 0);
}

/// The direction of lambda_tau at each node, which must be the same in all snapshots.
Vector slip_directions(const Matrix &tangential) {
  const double noise = 1e-8 * tangential.cwiseAbs().maxCoeff();
  Vector direction = Vector::Ones(tangential.rows());
  for (Index i = 0; i < direction.size(); ++i) {
    const double most = tangential.row(i).maxCoeff(), least = tangential.row(i).minCoeff();
    if (most > noise && least < -noise)
      throw failure("the tangential stress takes both directions at one node: cones hold one; use "
                    "another -multiplier_reduction");
    if (least < -noise) direction[i] = -1;
  }
  return direction;
}

} // namespace

Matrix multiplier_functions(const Matrix &nodal, const MultiplierBasis &basis) {
  return nodal * multiplier_coefficients(basis);
}

DenseModes dense_pod(const Matrix &snapshots, const SparseMatrix &product, double tolerance) {
  const Matrix factor = product_factor(product);
  const Matrix coordinates = factor * snapshots;
  const double total = coordinates.norm();
  if (!(total > 0)) throw failure("POD of multipliers: all snapshots are zero");
  const SmallSvd svd = small_svd(coordinates);
  DenseModes modes;
  double rest = 0;
  std::vector<double> tail{0};
  for (Index k = svd.values.size(); k-- > 0;) {
    rest += svd.values[k] * svd.values[k];
    tail.push_back(std::sqrt(rest) / total);
  }
  modes.error.assign(tail.rbegin(), tail.rend());
  Index count = 1;
  while (count < svd.values.size() && modes.error[static_cast<std::size_t>(count)] > tolerance)
    ++count;
  modes.columns = svd.left.leftCols(count);
  factor.triangularView<Eigen::Upper>().solveInPlace(modes.columns);
  return modes;
}

MultiplierBases make_multiplier_basis(const Matrix &coefficients, const SparseMatrix &product,
                                      const std::vector<NodeLaws> &laws,
                                      const MultiplierOptions &options,
                                      const ConeOptions &cone_options) {
  MultiplierBases bases;
  if (options.reduction == MultiplierReduction::condensed) return bases;
  const bool friction = laws.front().has_tangents();
  const Index nodes = laws.front().nodes(), tangents = coefficients.rows() - nodes;
  const Matrix normal = coefficients.topRows(nodes);
  const Matrix tangential = coefficients.bottomRows(tangents);
  if (friction && (tangential.array() == 0).all())
    throw failure("no snapshot has a tangential stress: use -multiplier_reduction condensed");
  MultiplierBasis &basis = bases.basis;
  if (options.reduction == MultiplierReduction::joint) {
    const DenseModes modes = dense_pod(coefficients, product, options.tangential);
    bases.tangential = modes.error;
    basis.normal = modes.columns.topRows(nodes);
    basis.tangential = modes.columns.bottomRows(tangents);
    const Index count = std::min(nodes, modes.columns.cols() + options.extra_nodes);
    Matrix values = Matrix::Zero(2 * nodes, modes.columns.cols()); // of lambda_n, lambda_tau
    values.topRows(nodes) = basis.normal;
    const std::vector<Index> with_tangent = nodes_with_tangent(laws.front());
    for (std::size_t k = 0; k < with_tangent.size(); ++k)
      values.row(nodes + with_tangent[k]) = basis.tangential.row(static_cast<Index>(k));
    basis.nodes = pivot_nodes(values, static_cast<int>(count));
    return bases;
  }
  const Cone cone = build_cone(normal, block(product, 0, nodes), cone_options);
  basis.normal = cone.basis.generators;
  bases.normal = cone.history;
  if (!friction) return bases;
  const SparseMatrix product_t = block(product, nodes, tangents);
  if (options.reduction == MultiplierReduction::cones) {
    basis.slip = slip_directions(tangential);
    const Cone left =
        build_cone(left_to_bound(coefficients, tangential, laws), product_t, cone_options);
    basis.tangential = left.basis.generators;
    bases.left_to_bound = left.history;
    return bases;
  }
  const DenseModes modes = dense_pod(tangential, product_t, options.tangential);
  basis.tangential = modes.columns;
  bases.tangential = modes.error;
  return bases;
}

} // namespace rbvi
