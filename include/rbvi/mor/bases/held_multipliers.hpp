// Multipliers that hold a part of the contact region where it is: given those at other nodes, which
// l_P on the nodes P make the displacement u of A u = B^T l vanish there, (B u)_P = 0? With the
// condensed operator H = B A^-1 B^T, l_P = -H_PP^-1 H_P: l_others.
#pragma once

#include "rbvi/law/lcp.hpp"
#include "rbvi/problem/problem.hpp"

#include <functional>
#include <vector>

namespace rbvi {

/// From P and `others` (dual dofs x any number, zero on P) to l_P, |P| x the same number.
using HoldingMultipliers =
    std::function<Matrix(const std::vector<Index> &held, const Matrix &others)>;

/// By the columns of H on P. Throws failure if H_PP is not positive definite.
Matrix hold_by_columns(const ColumnSource &condensed, const std::vector<Index> &held,
                       const Matrix &others);

/// By solves with A without the dofs of P, one for each column of `others`: l_P are the reactions
/// there. For a B whose rows P have one entry each, of different dofs (holds_dofs).
Matrix hold_by_reactions(const Problem &problem, const Operators &op,
                         const std::vector<Index> &held, const Matrix &others);

/// Whether rows P of B have one entry each, of different dofs, as by vertex quadrature.
bool holds_dofs(const SparseMatrix &b, const std::vector<Index> &held);

/// The one of the two with fewer solves that B allows. Both arguments must outlive the result, whose
/// calls are collective.
HoldingMultipliers holding(const Problem &problem, const Operators &op);

} // namespace rbvi
