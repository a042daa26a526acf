// The part of a nodal dual basis that can carry: multipliers far from contact are zero for every
// mu, and the condensed operator does without them.
#pragma once

#include "rbvi/contact/contact.hpp"

namespace rbvi {

/// The columns of a nodal dual basis (dual dofs x any number) whose nodes carry in some sample
/// (`snapshots`: multipliers, dual dofs x P), or are no farther from one that does than `ring`
/// times the extent of those of their interface (the diagonal of their bounding box), rising. All
/// of an interface on which fewer than two nodes carry. Infinite: all.
std::vector<Index> columns_near_contact(const Contact &contact, const Matrix &basis,
                                        const Matrix &snapshots, double ring);

} // namespace rbvi
