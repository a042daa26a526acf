#include "rbvi/solve/linear/linear.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/par/collective.hpp"

namespace rbvi {

Handle<KSP> make_direct_solver(MPI_Comm comm, const char *prefix) {
  const int ranks = ranks_of(comm);
  Handle<KSP> ksp;
  RBVI_CALL(KSPCreate(comm, ksp.put()));
  RBVI_CALL(KSPSetOptionsPrefix(ksp.get(), prefix));
  RBVI_CALL(KSPSetType(ksp.get(), KSPPREONLY));
  PC pc = nullptr;
  RBVI_CALL(KSPGetPC(ksp.get(), &pc));
  RBVI_CALL(PCSetType(pc, PCCHOLESKY));
  RBVI_CALL(PCFactorSetMatSolverType(pc, ranks == 1 ? MATSOLVERCHOLMOD : MATSOLVERMUMPS));
  // An iterative method that an option asks for is to be as good as the direct one.
  RBVI_CALL(KSPSetTolerances(ksp.get(), 1e-12, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  RBVI_CALL(KSPSetFromOptions(ksp.get()));
  return ksp;
}

void solve_linear(KSP ksp, Vec rhs, Vec x) {
  RBVI_CALL(KSPSolve(ksp, rhs, x));
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  RBVI_CALL(KSPGetConvergedReason(ksp, &reason));
  if (reason < 0)
    throw failure(
        std::string("the linear solver stopped with ") + KSPConvergedReasons[reason] +
        ": is the stiffness matrix singular? Try -hf_pc_type lu or a tighter -hf_ksp_rtol");
}

} // namespace rbvi
