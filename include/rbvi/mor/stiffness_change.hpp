// The terms of A on a large primal basis where A(mu) - A(mu_1) vanishes on all dofs but some: the
// basis restricted to these is U Q^T to round-off, U of few columns, and
//
//   V^T (A(mu) - A(mu_1)) V = Q (U^T (A(mu) - A(mu_1)) U) Q^T.
//
// Supremizers of contact are smooth away from it, and a map moves the mesh outside the contact
// region: 110 columns stand for 1700.
#pragma once

#include "rbvi/fem/problem.hpp"
#include "rbvi/model/model.hpp"
#include "rbvi/mor/eim.hpp"

namespace rbvi {

/// `set`: the mu of eim.snapshots; A_1 is A of the first. `basis`: V, n columns. Without rank where
/// that would save nothing: for small bases, a sum with exact terms, a rank above n / 3.
/// Collective.
StiffnessChange stiffness_change(Problem &problem, const Eim &eim, const std::vector<Mu> &set,
                                 Mat basis);

} // namespace rbvi
