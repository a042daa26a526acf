// The constants of the high-fidelity pair of spaces (Niakh 2022, (2.3)), and the tolerance of the
// projected greedy that follows from them. Niakh (2022): (1.7), (2.4).
#pragma once

#include "rbvi/fem/problem.hpp"
#include "rbvi/mor/stability.hpp"
#include "rbvi/par/petsc.hpp"

namespace rbvi {

/// Smallest and largest singular value of b between V and the span of all multipliers, normal and
/// tangential ones together.
struct PairConstants {
  double beta, c;
};

/// By SLEPc's EPS, prefix infsup_: beta^2 and c^2 are the smallest and the largest eigenvalue of
/// B V^-1 B^T x = lambda W x. The largest one is found with `v`, a solver of V; the smallest one as
/// that of
///   [ V  B^T ] [ u ]            [ 0  0 ] [ u ]
///   [ B  0   ] [ x ] = -lambda  [ 0  W ] [ x ]
/// nearest to zero, by inverse iteration: one factorisation of the matrix on the left by MUMPS over
/// the ranks. Without it the condition number, c^2 / beta^2, grows with each refinement. `b`:
/// multipliers x displacement dofs; `w`: their Gram matrix. Throws failure if rows of b depend on
/// each other, or if an iteration does not converge. Collective.
PairConstants iterated_constants(KSP v, Mat b, Mat w);

/// The EPS of both for so many multipliers, its options read. Throws failure for a value that SLEPc
/// refuses. Collective.
Handle<EPS> make_infsup_eps(MPI_Comm comm, PetscInt multipliers);

/// Whether iterations find them faster than dense matrices: m^3 > 1e5 n for m multipliers and n
/// displacement dofs (a region of more than some 700 nodes; on a curve hardly ever).
bool iterates_constants(double multipliers, double dofs);
bool iterates_constants(const Problem &problem);

/// beta_HF and c_HF at one mu by one dense SVD of the number of multipliers (prefix infsup_). `op`:
/// the contact operators there; `space`: of all contact dofs. Of two bodies over the multipliers
/// whose support has a partner everywhere: the others press on nothing, or on next to nothing. Not
/// collective. Throws failure where the SVD fails.
PairConstants dense_constants(const Problem &problem, const RieszSpace &space, const Operators &op);

/// The same by the iterations of all ranks. `v`: a solver of the V product. Collective.
PairConstants iterated_constants(Problem &problem, KSP v, const Operators &op);

/// At each point of a set, on every rank, in the V product `product`. `space`: of all contact dofs
/// in it; not read where they are iterated. Collective.
std::vector<PairConstants> high_fidelity_pairs(Problem &problem, Mat product,
                                               const RieszSpace &space,
                                               const std::vector<ContactPoint> &set);

/// The smallest beta_HF(mu) / c_HF(mu) over `set`, at most 0.999, in the V product `product`: since
/// beta_on >= beta_HF and c_S <= c_HF there, sigma_S below it meets (2.23) at every mu of the set.
/// Collective. Throws failure where beta_HF is zero to round-off.
double infsup_tolerance(Problem &problem, Mat product, const std::vector<ContactPoint> &set);

} // namespace rbvi
