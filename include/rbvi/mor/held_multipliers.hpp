// Nodes P that are in contact at every parameter do not move. Given multipliers l at the other
// nodes, those at P, l_P, are such that the displacement u of A u = B^T l fulfils (B u)_P = 0: with
// the condensed operator H = B A^-1 B^T, l_P = -H_PP^-1 H_P: l_others.
#pragma once

#include "rbvi/fem/problem.hpp"
#include "rbvi/method/lcp.hpp"

#include <functional>
#include <optional>
#include <vector>

namespace rbvi {

/// From P and `others` (dual dofs x any number, zero on P) to l_P, |P| x the same number.
using HoldingMultipliers =
    std::function<Matrix(const std::vector<Index> &held, const Matrix &others)>;

/// By the columns of H on P. Throws failure if H_PP is not positive definite.
Matrix hold_by_columns(const ColumnSource &condensed, const std::vector<Index> &held,
                       const Matrix &others);

/// The dofs that rows P of B hold, and the entries there.
struct HeldDofs {
  std::vector<Index> dofs;
  Vector entries;
};

/// Nothing where a row has more entries than one, or two rows the same dof: vertex quadrature has
/// one each.
std::optional<HeldDofs> held_dofs(const SparseMatrix &b, const std::vector<Index> &held);

/// By solves with A without the dofs of P, one for each column of `others`: l_P are the reactions
/// there. Collective.
Matrix hold_by_reactions(const Problem &problem, const Operators &op, const HeldDofs &held,
                         const Matrix &others);

/// The one of the two with fewer solves that B allows. Both arguments must outlive the result,
/// whose calls are collective.
HoldingMultipliers holding(const Problem &problem, const Operators &op);

} // namespace rbvi
