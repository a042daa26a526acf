// Where the active set is fixed the multiplier is no unknown of its own. Let P be the nodes in
// contact for every training mu and M those over which the edge of contact moves. With the
// condensed operator H = B A^-1 B^T of one mu, complementarity on P is H_PP l_P + H_PM l_M + q_P =
// 0, so that
//
//   l_P = E l_M - H_PP^-1 q_P,   E = -H_PP^-1 H_PM.
//
// The generators are the hat functions of M continued by E: their coefficients are the nodal
// pressures, so that l >= 0 on M is x >= 0. What is left of the snapshots lives on P, is smooth in
// mu (the term of q, and the change of H), and a few modes of either sign hold it.
#include "cone_tools.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/par/small_svd.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <string>

namespace rbvi {

namespace {

struct ContactZones {
  std::vector<Index> permanent, moving;
};

ContactZones zones_of(const Matrix &snapshots, const SparseMatrix &product, int ring) {
  std::vector<bool> ever = ever_in_contact(snapshots), open = ever_open(snapshots);
  for (int layer = 0; layer < ring; ++layer) {
    add_neighbours(ever, product);
    add_neighbours(open, product);
  }
  ContactZones zones;
  for (std::size_t i = 0; i < ever.size(); ++i) {
    if (!open[i]) zones.permanent.push_back(static_cast<Index>(i));
    if (open[i] && ever[i]) zones.moving.push_back(static_cast<Index>(i));
  }
  return zones;
}

/// Rows and columns of some nodes.
SparseMatrix block_of(const SparseMatrix &product, const std::vector<Index> &nodes) {
  std::vector<Index> position(static_cast<std::size_t>(product.rows()), -1);
  for (std::size_t k = 0; k < nodes.size(); ++k)
    position[static_cast<std::size_t>(nodes[k])] = static_cast<Index>(k);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < nodes.size(); ++k)
    for (SparseMatrix::InnerIterator entry(product, nodes[k]); entry; ++entry)
      if (const Index column = position[static_cast<std::size_t>(entry.col())]; column >= 0)
        entries.emplace_back(static_cast<int>(k), static_cast<int>(column), entry.value());
  SparseMatrix block(std::ssize(nodes), std::ssize(nodes));
  block.setFromTriplets(entries.begin(), entries.end());
  return block;
}

/// E: permanent x moving nodes.
Matrix continuation(const ContactZones &zones, const ColumnSource &condensed) {
  if (zones.permanent.empty() || zones.moving.empty())
    return Matrix(static_cast<Index>(zones.permanent.size()),
                  static_cast<Index>(zones.moving.size()));
  if (!condensed) throw failure("a hybrid cone needs columns of the condensed operator");
  const Matrix columns = condensed(zones.permanent);
  const Matrix block = columns(zones.permanent, Eigen::all);
  const Eigen::LLT<Matrix> factor((block + block.transpose()) / 2);
  if (factor.info() != Eigen::Success)
    throw failure("the condensed operator is not positive definite on the nodes in permanent "
                  "contact: try another -reference_mu");
  return -factor.solve(columns(zones.moving, Eigen::all).transpose());
}

/// Modes of what the generators leave of the snapshots, and the history of their number. `root`: of
/// W on the permanent nodes, on which the columns of the result are coefficients.
Matrix modes_of(const Matrix &remainder, const ProductRoot &root, double largest,
                const ConeOptions &options, Index generators, ConeHistory &history) {
  const SmallSvd svd = small_svd(root.times(remainder));
  const Vector &values = svd.values;
  const Matrix parts = values.asDiagonal() * svd.right.transpose();
  // Equal singular values stay together: which of their vectors come first is round-off.
  const auto splits = [&](Index modes) {
    return modes > 0 && modes < values.size() && values[modes] > (1 - 1e-8) * values[modes - 1];
  };
  Index bound = values.size();
  if (options.max_size > 0) bound = std::min(bound, options.max_size - generators);
  while (splits(bound))
    --bound;
  if (generators + bound == 0)
    throw failure("the first singular values of the multipliers are equal and more than the cone "
                  "may have: raise -cone_max_size");
  for (Index modes = generators > 0 ? 0 : 1;; ++modes) {
    const double left = parts.bottomRows(parts.rows() - modes).colwise().norm().maxCoeff();
    history.size.push_back(static_cast<int>(generators + modes));
    history.error.push_back(left / largest);
    if (history.error.back() <= options.tolerance)
      history.reason = "tolerance reached";
    else if (history.error.back() <= round_off || modes == values.size())
      history.reason = "round-off reached";
    else if (modes == bound)
      history.reason = "size reached";
    if (history.reason.empty() || splits(modes)) continue;
    return modes > 0 ? root.solve(svd.left.leftCols(modes)) : Matrix(remainder.rows(), 0);
  }
}

} // namespace

Cone hybrid_cone(const Matrix &snapshots, const SparseMatrix &product, const ConeOptions &options,
                 const ColumnSource &condensed) {
  const ProductRoot root(product);
  const ContactZones zones = zones_of(snapshots, product, options.ring);
  const auto moving = static_cast<Index>(zones.moving.size());
  if (options.max_size > 0 && options.max_size < moving)
    throw failure("the edge of contact moves over " + std::to_string(moving) +
                  " nodes: a hybrid cone needs a larger -cone_max_size");
  const Matrix extension = continuation(zones, condensed);
  Matrix hats = Matrix::Zero(snapshots.rows(), moving);
  for (Index k = 0; k < moving; ++k)
    hats(zones.moving[static_cast<std::size_t>(k)], k) = 1;
  hats(zones.permanent, Eigen::all) = extension;

  Cone cone;
  cone.history.size.push_back(0);
  cone.history.error.push_back(1);
  cone.basis.generators = hats * root.times(hats).colwise().norm().cwiseInverse().asDiagonal();
  const auto permanent = static_cast<Index>(zones.permanent.size());
  cone.modes.columns = Matrix::Zero(snapshots.rows(), 0);
  if (permanent == 0) {
    cone.history.size.push_back(static_cast<int>(moving));
    cone.history.error.push_back(0);
    cone.history.reason = "round-off reached";
  } else {
    const Matrix remainder =
        snapshots(zones.permanent, Eigen::all) - extension * snapshots(zones.moving, Eigen::all);
    const Matrix modes =
        modes_of(remainder, ProductRoot(block_of(product, zones.permanent)),
                 root.times(snapshots).colwise().norm().maxCoeff(), options, moving, cone.history);
    cone.modes.columns.setZero(snapshots.rows(), modes.cols());
    cone.modes.columns(zones.permanent, Eigen::all) = modes;
  }
  cone.history.gram_condition = gram_conditions(root.times(cone.all()), cone.history.size[1]);
  return cone;
}

} // namespace rbvi
