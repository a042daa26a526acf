// The laws of contact of the columns of a nodal dual basis, and where they end: a model of contact
// between the nodes near it knows nothing of the others. A column is a node, or a pair of mirror
// images, of one interface: x_n of all interfaces come first, then x_tau in the same order; an
// interface without friction has none.
#pragma once

#include "rbvi/contact/contact.hpp"

namespace rbvi {

struct ColumnLaws {
  NodeLaws laws;                 ///< without bounds
  std::vector<int> interface_of; ///< of each node
};

/// `dual_basis`: dual size x columns.
ColumnLaws laws_of_columns(const Contact &contact, const Matrix &dual_basis);

/// With the bounds at mu. Throws failure for a bound that is negative.
NodeLaws laws_at(const ColumnLaws &columns, const Contact &contact, const FullMu &mu);

/// The node of each tangential multiplier.
std::vector<Index> nodes_with_tangent(const NodeLaws &laws);

/// What to do where contact leaves these nodes.
inline constexpr const char *keeps_more =
    "reduce again with training parameters up to the ends of the box, or with more of them";

/// The columns for lambda_n of a nodal dual basis (dual dofs x any number) at the nodes that are
/// nearest to some node of their interface without a column, rising; none where every node has one.
std::vector<Index> edge_of_nodes(const Contact &contact, const Matrix &basis);

} // namespace rbvi
