#include "edge_of_nodes.hpp"

#include <algorithm>
#include <set>

namespace rbvi {

namespace {

/// The nearest of some nodes.
Index nearest(const std::vector<Point> &points, const std::vector<Index> &nodes, Index to) {
  using At = Eigen::Map<const Eigen::Vector3d>;
  const auto distance = [&](Index node) {
    return (At(points[node].data()) - At(points[to].data())).squaredNorm();
  };
  return *std::ranges::min_element(nodes, {}, distance);
}

} // namespace

std::vector<Index> edge_of_nodes(const Contact &contact, const Matrix &basis) {
  const Vector rows = basis.rowwise().lpNorm<Eigen::Infinity>();
  if (rows.size() == 0 || rows.minCoeff() > 0) return {};
  std::set<Index> columns;
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i) {
    const DualSpace &dual = contact.interfaces[i]->dual();
    const auto normal = rows.segment(contact.first_row[i], dual.nodes());
    std::vector<Index> with;
    std::set<Index> edge;
    for (Index node = 0; node < dual.nodes(); ++node)
      if (normal[node] > 0) with.push_back(node);
    for (Index node = 0; node < dual.nodes() && !with.empty(); ++node)
      if (!(normal[node] > 0)) edge.insert(nearest(dual.points, with, node));
    for (const Index node : edge)
      for (Index column = 0; column < basis.cols(); ++column)
        if (basis(contact.first_row[i] + node, column) != 0) columns.insert(column);
  }
  return {columns.begin(), columns.end()};
}

} // namespace rbvi
