#include "../index.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/law/friction/least_squares_friction.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

constexpr double equal = 1e-10; ///< relative: sizes that only round-off tells apart

/// The column of the largest size; of equals the one of the lowest node, normal before tangential.
Index most_important(const Vector &sizes) {
  const Index nodes = sizes.size() / 2;
  const double edge = (1 - equal) * sizes.maxCoeff();
  Index node = 0;
  while (sizes[node] < edge && sizes[nodes + node] < edge)
    ++node;
  return sizes[node] < edge ? nodes + node : node;
}

/// One QR with column pivoting: the nodes of its pivots, at most `count`, marked in `taken`.
std::vector<int> pivots(Matrix columns, std::size_t count, std::vector<char> &taken) {
  const Index nodes = columns.cols() / 2;
  std::vector<int> result;
  Vector sizes = columns.colwise().norm().transpose();
  const double least = equal * sizes.maxCoeff();
  while (result.size() < count && sizes.maxCoeff() > least) {
    const Index pivot = most_important(sizes), node = pivot % nodes;
    char &known = taken[at(node)];
    if (known == 0) result.push_back(static_cast<int>(node));
    known = 1;
    const Vector direction = columns.col(pivot) / sizes[pivot];
    columns -= direction * (direction.transpose() * columns).eval();
    columns.col(pivot).setZero();
    sizes = columns.colwise().norm().transpose();
  }
  return result;
}

} // namespace

std::vector<int> pivot_nodes(const Matrix &basis, int count) {
  const Index nodes = basis.rows() / 2;
  if (basis.rows() % 2 != 0 || basis.size() == 0)
    throw failure("pivot nodes: the basis has " + std::to_string(basis.rows()) +
                  " rows; give normal values at all nodes, then as many tangential ones");
  if (count < 0 || count > nodes)
    throw failure("pivot nodes: " + std::to_string(count) + " of " + std::to_string(nodes) +
                  " nodes asked for");
  if (!basis.allFinite()) throw failure("pivot nodes: the basis is not finite");
  const std::size_t wanted = static_cast<std::size_t>(count);
  const double largest = basis.cwiseAbs().maxCoeff();
  Matrix columns = basis.transpose() / (largest > 0 ? largest : 1.0);
  std::vector<char> taken(at(nodes), 0);
  std::vector<int> result;
  // Nodes beyond the rank: what is left is pivoted anew.
  while (result.size() < wanted) {
    const std::vector<int> more = pivots(columns, wanted - result.size(), taken);
    if (more.empty()) break;
    result.insert(result.end(), more.begin(), more.end());
    for (const int node : more) {
      columns.col(node).setZero();
      columns.col(nodes + node).setZero();
    }
  }
  for (Index node = 0; result.size() < wanted; ++node)
    if (taken[at(node)] == 0) result.push_back(static_cast<int>(node));
  return result;
}

} // namespace rbvi
