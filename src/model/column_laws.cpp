#include "rbvi/model/column_laws.hpp"

#include <algorithm>

namespace rbvi {

ColumnLaws laws_of_columns(const Contact &contact, const Matrix &dual_basis) {
  const std::size_t interfaces = contact.interfaces.size();
  std::vector<std::vector<Index>> normal(interfaces), tangent(interfaces), fixed(interfaces);
  for (std::size_t i = 0; i < interfaces; ++i)
    fixed[i] = contact.interfaces[i]->partly_fixed();
  std::vector<bool> without_bound(dual_basis.cols(), false);
  for (Index column = 0; column < dual_basis.cols(); ++column) {
    Index row = 0;
    dual_basis.col(column).cwiseAbs().maxCoeff(&row);
    const DualRow of = dual_row(contact, row);
    (of.normal ? normal : tangent)[of.interface].push_back(column);
    without_bound[column] = std::ranges::binary_search(fixed[of.interface], of.node);
  }
  ColumnLaws columns;
  NodeLaws &laws = columns.laws;
  laws.rows = dual_basis.cols();
  for (std::size_t i = 0; i < interfaces; ++i)
    for (std::size_t k = 0; k < normal[i].size(); ++k) {
      laws.normal.push_back(normal[i][k]);
      laws.tangent.push_back(tangent[i].empty() ? -1 : tangent[i].at(k));
      columns.interface_of.push_back(static_cast<int>(i));
      columns.without_bound.push_back(without_bound[normal[i][k]]);
    }
  laws.bound.resize(laws.normal.size());
  return columns;
}

NodeLaws laws_at(const ColumnLaws &columns, const Contact &contact, const FullMu &mu) {
  NodeLaws laws = columns.laws;
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i) {
    const FrictionBound bound = contact.interfaces[i]->bound(mu);
    for (std::size_t k = 0; k < laws.bound.size(); ++k)
      if (columns.interface_of[k] == static_cast<int>(i) && !columns.without_bound[k])
        laws.bound[k] = bound;
  }
  return laws;
}

std::vector<Index> nodes_with_tangent(const NodeLaws &laws) {
  std::vector<Index> nodes;
  for (Index i = 0; i < laws.nodes(); ++i)
    if (laws.has_tangent(i)) nodes.push_back(i);
  return nodes;
}

} // namespace rbvi
