#include "edge_of_nodes.hpp"

#include <algorithm>
#include <limits>

namespace rbvi {

namespace {

/// The nearest of some nodes.
Index nearest(const std::vector<Point> &points, const std::vector<Index> &nodes, const Point &to) {
  double least = std::numeric_limits<double>::infinity();
  Index found = -1;
  for (const Index node : nodes) {
    const Point &from = points[static_cast<std::size_t>(node)];
    double squared = 0;
    for (std::size_t c = 0; c < to.size(); ++c)
      squared += (from[c] - to[c]) * (from[c] - to[c]);
    if (squared < least) {
      least = squared;
      found = node;
    }
  }
  return found;
}

} // namespace

std::vector<Index> edge_of_nodes(const Contact &contact, const Matrix &basis) {
  const Vector rows = basis.rowwise().lpNorm<Eigen::Infinity>();
  std::vector<bool> edge(static_cast<std::size_t>(basis.cols()), false);
  if (rows.size() == 0 || rows.minCoeff() > 0) return {};
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i) {
    const DualSpace &dual = contact.interfaces[i]->dual();
    const Index first = contact.first_row[i];
    std::vector<Index> with;
    for (Index node = 0; node < dual.nodes(); ++node)
      if (rows[first + node] > 0) with.push_back(node);
    for (Index node = 0; node < dual.nodes() && !with.empty(); ++node) {
      if (rows[first + node] > 0) continue;
      const Point &point = dual.points[static_cast<std::size_t>(node)];
      const Index beside = nearest(dual.points, with, point);
      for (Index row = first + beside; row < first + dual.size(); row += dual.nodes())
        for (Index column = 0; column < basis.cols(); ++column)
          if (basis(row, column) != 0) edge[static_cast<std::size_t>(column)] = true;
    }
  }
  std::vector<Index> columns;
  for (std::size_t column = 0; column < edge.size(); ++column)
    if (edge[column]) columns.push_back(static_cast<Index>(column));
  return columns;
}

} // namespace rbvi
