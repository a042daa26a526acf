#include "rbvi/model/column_laws.hpp"

#include <algorithm>
#include <set>

namespace rbvi {

ColumnLaws laws_of_columns(const Contact &contact, const Matrix &dual_basis) {
  const std::size_t interfaces = contact.interfaces.size();
  std::vector<std::vector<Index>> normal(interfaces), tangent(interfaces);
  std::vector<std::vector<int>> free(interfaces);
  for (std::size_t i = 0; i < interfaces; ++i)
    free[i] = contact.interfaces[i]->free_tangents();
  std::vector<int> of_column(dual_basis.cols());
  for (Index column = 0; column < dual_basis.cols(); ++column) {
    Index row = 0;
    dual_basis.col(column).cwiseAbs().maxCoeff(&row);
    const DualRow of = dual_row(contact, row);
    (of.normal ? normal : tangent)[of.interface].push_back(column);
    of_column[column] = free[of.interface][of.node];
  }
  ColumnLaws columns;
  NodeLaws &laws = columns.laws;
  laws.rows = dual_basis.cols();
  for (std::size_t i = 0; i < interfaces; ++i)
    if (!tangent[i].empty()) laws.tangents = contact.interfaces[i]->dual().components - 1;
  const auto each = static_cast<std::size_t>(laws.tangents);
  for (std::size_t i = 0; i < interfaces; ++i)
    for (std::size_t k = 0; k < normal[i].size(); ++k) {
      laws.normal.push_back(normal[i][k]);
      laws.tangent.push_back(tangent[i].empty() ? -1 : tangent[i].at(each * k));
      columns.interface_of.push_back(static_cast<int>(i));
      laws.free.push_back(of_column[normal[i][k]]);
    }
  laws.bound.resize(laws.normal.size());
  return columns;
}

NodeLaws laws_at(const ColumnLaws &columns, const Contact &contact, const FullMu &mu) {
  NodeLaws laws = columns.laws;
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i) {
    const FrictionBound bound = contact.interfaces[i]->bound(mu);
    for (std::size_t k = 0; k < laws.bound.size(); ++k)
      if (columns.interface_of[k] == static_cast<int>(i) && laws.free[k] > 0) laws.bound[k] = bound;
  }
  return laws;
}

std::vector<Index> nodes_with_tangent(const NodeLaws &laws) {
  std::vector<Index> nodes;
  for (Index i = 0; i < laws.nodes(); ++i)
    if (laws.has_tangent(i)) nodes.push_back(i);
  return nodes;
}

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
