// The methods behind HighFidelity, each on one assembled problem.
#pragma once

#include "rbvi/solve/high_fidelity.hpp"

namespace rbvi {

/// What a method returns: the free displacement, the multiplier, and how it ended.
struct MethodResult {
  Handle<Vec> u;
  Vector lambda;
  std::vector<Index> active;
  int iterations = 0;
  int columns = 0;
  bool converged = false;
  std::string reason;
};

/// KSP that factorises once per operator: preonly with Cholesky by CHOLMOD on one rank, by MUMPS on
/// several; options under `prefix` override. Collective.
Handle<KSP> make_direct_solver(MPI_Comm comm, const char *prefix);

/// x = A^-1 rhs, throwing failure when KSP does not converge. Collective.
void solve_linear(KSP ksp, Vec rhs, Vec x);

/// F - B^T lambda. Collective.
Handle<Vec> reaction_rhs(const Trace &trace, const Operators &op, const Vector &lambda);

/// B A^-1 B^T(:, which), dual x which.size(), on every rank: the constraint values that unit
/// multipliers cause. `ksp`: with op.a as its operator. Collective.
Matrix condensed_columns(KSP ksp, const Trace &trace, const Operators &op,
                         const std::vector<Index> &which);

MethodResult solve_active_set(KSP ksp, const Trace &trace, const Operators &op,
                              const std::vector<Index> &start);

MethodResult solve_uzawa(KSP ksp, const Trace &trace, const Operators &op,
                         const SparseMatrix &w_product, const HfOptions &options);

/// Needs a `b` with one entry per row (vertex quadrature).
MethodResult solve_vi(const Problem &problem, const Operators &op);

KktResidual kkt_residual(const Trace &trace, const Operators &op, Vec u, const Vector &lambda);

} // namespace rbvi
