// Dual bases whose coefficients are values at nodes, of the mesh or of a coarser one, and the part
// of one that can carry: multipliers far from contact are zero for every mu, and the condensed
// operator does without them.
#pragma once

#include "rbvi/contact/contact.hpp"
#include "rbvi/fem/problem.hpp"

namespace rbvi {

/// The hat functions of the multipliers of the mesh with `level` refinements less: dual dofs of
/// `problem` x those of that mesh. Collective. Throws bad_input where there is no such mesh.
SparseMatrix hats_of_level(const Problem &problem, int level);

/// Multipliers of mirror images in one column each where the scene is symmetric, the mesh is, and
/// the multipliers in `snapshots` (dual dofs x P) are to 1e-8; else one column for each dual dof.
/// Columns for lambda_n first, as many again with friction. Of a `level` above 0: the hat functions
/// of hats_of_level in place of nodes. A coefficient is the multiplier's value at its node, so that
/// the bound of friction at the nodes bounds it everywhere. Collective.
Matrix nodal_dual_basis(const Problem &problem, const Matrix &snapshots, int level = 0);

/// Coefficients of multipliers (dual dofs x P) in such a basis, by least squares.
Matrix nodal_coefficients(const Matrix &basis, const Matrix &multipliers);

/// The columns of a nodal dual basis (dual dofs x any number) whose nodes carry in some sample
/// (`snapshots`: multipliers, dual dofs x P), or are no farther from one that does than `ring`
/// times the extent of those of their interface (the diagonal of their bounding box), rising. All
/// of an interface on which fewer than two nodes carry. Infinite: all.
std::vector<Index> columns_near_contact(const Contact &contact, const Matrix &basis,
                                        const Matrix &snapshots, double ring);

} // namespace rbvi
