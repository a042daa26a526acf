// The constants of the high-fidelity pair of spaces (Niakh 2022, (2.3)), and the tolerance of the
// projected greedy that follows from them.
#pragma once

#include "rbvi/fem/problem.hpp"
#include "rbvi/mor/high_fidelity_constant.hpp"
#include "rbvi/mor/stability.hpp"

#include <optional>

namespace rbvi {

/// beta_HF and c_HF: smallest and largest singular value of b between V and the span of all
/// multipliers, normal and tangential ones together.
struct PairConstants {
  double beta, c;
};

/// What takes the place of dense matrices where it is faster: m^3 > 1e5 n for m multipliers and n
/// displacement dofs (a region of more than some 700 nodes; on a curve hardly ever). Else nothing.
/// Collective on the problem's communicator.
std::optional<SparseInfSup> sparse_infsup(Problem &problem);

/// `op`: the contact operators at one mu; `space`: of all contact dofs. Of two bodies over the
/// multipliers whose support has a partner everywhere: the others press on nothing, or on next to
/// nothing. One dense SVD of the number of multipliers; with `sparse` by iterations, without dense
/// matrices of the multipliers. Not collective. Throws failure where the SVD or the iteration
/// fails.
PairConstants high_fidelity_pair(const Problem &problem, const RieszSpace &space,
                                 const Operators &op,
                                 const std::optional<SparseInfSup> &sparse = {});

/// The smallest beta_HF(mu) / c_HF(mu) over `set`, at most 0.999, in the product of `space` (all
/// contact dofs): since beta_on >= beta_HF and c_S <= c_HF there, sigma_S below it meets (2.23) at
/// every mu of the set. Collective on `comm`, among whose ranks the mu are shared. Throws failure
/// where beta_HF is zero to round-off.
double infsup_tolerance(MPI_Comm comm, Problem &problem, const RieszSpace &space,
                        const std::vector<ContactPoint> &set);

} // namespace rbvi
