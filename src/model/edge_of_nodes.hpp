// A model of contact between the nodes near it knows nothing of the others: what its edge is.
#pragma once

#include "rbvi/contact/contact.hpp"

namespace rbvi {

/// What to do where contact leaves these nodes.
inline constexpr const char *keeps_more =
    "reduce again with training parameters up to the ends of the box, or with more of them";

/// The columns for lambda_n of a nodal dual basis (dual dofs x any number) at the nodes that are
/// nearest to some node of their interface without a column, rising; none where every node has one.
std::vector<Index> edge_of_nodes(const Contact &contact, const Matrix &basis);

} // namespace rbvi
