// Where the active set is fixed the multiplier is no unknown of its own. Let P be the nodes in
// contact for every training mu and M those over which the edge of contact moves. With the
// condensed operator H = B A^-1 B^T of one mu, complementarity on P is H_PP l_P + H_PM l_M + q_P =
// 0, so that
//
//   l_P = E l_M - H_PP^-1 q_P,   E = -H_PP^-1 H_PM.
//
// The generators are the hat functions of M continued by E: their coefficients are the nodal
// pressures, so that l >= 0 on M is x >= 0. What is left of the snapshots lives on P, is smooth in
// mu (the term of q, and the change of H), and a few modes of either sign hold it. Hat functions of
// a coarser mesh are fewer; pressures over which the edge passes are then as smooth as they are.
#include "cone_tools.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/par/small_svd.hpp"

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

/// What the moving multipliers are combined from: functions of the nodes, `values` (moving nodes x
/// functions), and the zones that belong to them.
struct MovingFunctions {
  ContactZones zones;
  SparseMatrix values;
};

/// The functions (nodes x any number) that reach into the moving zone. The zone grows to all nodes
/// that they reach, but for those in permanent contact that others reach as well.
MovingFunctions functions_on(const ContactZones &zones, const SparseMatrix &functions) {
  std::vector<Index> column(functions.cols(), -1);
  for (const Index node : zones.moving)
    for (SparseMatrix::InnerIterator entry(functions, node); entry; ++entry)
      column[entry.col()] = 0;
  const Index taken = std::count(column.begin(), column.end(), 0);
  std::vector<bool> permanent(functions.rows(), false);
  for (const Index node : zones.permanent)
    permanent[node] = true;
  Index next = 0;
  for (Index &number : column)
    if (number == 0) number = next++;
  MovingFunctions result;
  std::vector<Eigen::Triplet<double>> entries;
  for (Index node = 0; node < functions.rows(); ++node) {
    std::vector<Eigen::Triplet<double>> row;
    bool all = true;
    for (SparseMatrix::InnerIterator entry(functions, node); entry; ++entry) {
      const Index number = column[entry.col()];
      if (number < 0) all = false;
      if (number >= 0)
        row.emplace_back(static_cast<int>(result.zones.moving.size()), static_cast<int>(number),
                         entry.value());
    }
    if (permanent[node] && !(all && !row.empty())) {
      result.zones.permanent.push_back(node);
    } else if (!row.empty()) {
      result.zones.moving.push_back(node);
      entries.insert(entries.end(), row.begin(), row.end());
    }
  }
  result.values.resize(std::ssize(result.zones.moving), taken);
  result.values.setFromTriplets(entries.begin(), entries.end());
  return result;
}

SparseMatrix hats_of_nodes(Index nodes) {
  SparseMatrix hats(nodes, nodes);
  hats.setIdentity();
  return hats;
}

/// E times some columns on the moving nodes (permanent nodes x the same number).
Matrix continued(const ContactZones &zones, const Matrix &on_moving, Index nodes,
                 const HoldingMultipliers &hold) {
  if (zones.permanent.empty() || zones.moving.empty())
    return Matrix::Zero(std::ssize(zones.permanent), on_moving.cols());
  if (!hold) throw failure("a hybrid cone needs the multipliers that hold permanent contact");
  Matrix others = Matrix::Zero(nodes, on_moving.cols());
  others(zones.moving, Eigen::all) = on_moving;
  // Without what is round-off, for most nodes far from the moving ones all of it.
  constexpr double noise = 1e-14;
  const Matrix result = hold(zones.permanent, others);
  const double least = noise * result.cwiseAbs().maxCoeff();
  return result.unaryExpr([&](double e) { return std::abs(e) > least ? e : 0.0; });
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
                 const HoldingMultipliers &hold) {
  const auto [zones, functions] =
      functions_on(zones_of(snapshots, product, options.ring),
                   options.hats.size() > 0 ? options.hats : hats_of_nodes(snapshots.rows()));
  const Index moving = functions.cols();
  if (options.max_size > 0 && options.max_size < moving)
    throw failure("the edge of contact moves over " + std::to_string(moving) +
                  " nodes: a hybrid cone needs a larger -cone_max_size, or a -cone_level");
  // Of the functions and of the snapshots.
  Matrix on_moving(std::ssize(zones.moving), moving + snapshots.cols());
  on_moving << Matrix(functions), snapshots(zones.moving, Eigen::all);
  const Matrix on_permanent = continued(zones, on_moving, snapshots.rows(), hold);
  // All on the nodes that the basis and the snapshots live on, the permanent ones first.
  std::vector<Index> nodes = zones.permanent;
  nodes.insert(nodes.end(), zones.moving.begin(), zones.moving.end());
  const ProductRoot root(block_of(product, nodes));
  Matrix functions_there(std::ssize(nodes), moving);
  functions_there << on_permanent.leftCols(moving), on_moving.leftCols(moving);
  functions_there *= root.times(functions_there).colwise().norm().cwiseInverse().asDiagonal();

  Cone cone;
  cone.history.size.push_back(0);
  cone.history.error.push_back(1);
  cone.basis.generators = Matrix::Zero(snapshots.rows(), moving);
  cone.basis.generators(nodes, Eigen::all) = functions_there;
  const auto permanent = std::ssize(zones.permanent);
  cone.modes.columns = Matrix::Zero(snapshots.rows(), 0);
  if (permanent == 0) {
    cone.history.size.push_back(static_cast<int>(moving));
    cone.history.error.push_back(0);
    cone.history.reason = "round-off reached";
  } else {
    const Matrix remainder =
        snapshots(zones.permanent, Eigen::all) - on_permanent.rightCols(snapshots.cols());
    const Matrix modes =
        modes_of(remainder, ProductRoot(block_of(product, zones.permanent)),
                 root.times(snapshots(nodes, Eigen::all)).colwise().norm().maxCoeff(), options,
                 moving, cone.history);
    cone.modes.columns.setZero(snapshots.rows(), modes.cols());
    cone.modes.columns(zones.permanent, Eigen::all) = modes;
    functions_there.conservativeResizeLike(
        Matrix::Zero(functions_there.rows(), moving + modes.cols()));
    functions_there.topRightCorner(permanent, modes.cols()) = modes;
  }
  cone.history.gram_condition = gram_conditions(root.times(functions_there), cone.history.size[1]);
  return cone;
}

} // namespace rbvi
