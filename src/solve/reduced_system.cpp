#include "reduced_system.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/solve/linear.hpp"
#include "rbvi/solve/vectors.hpp"

#include <string>

namespace rbvi {

void ReducedSystem::extend(Vec v) const {
  if (z.count() > 0) z.extend(Vector::Zero(std::ssize(z.pivots())), v);
}

void ReducedSystem::reduce(Vec r) const {
  if (w.count() > 0) w.reduce(r);
}

namespace {

template <class Call> PetscErrorCode reported(MPI_Comm comm, Call &&call) {
  try {
    call();
  } catch (const std::exception &error) {
    SETERRQ(comm, PETSC_ERR_LIB, "%s", error.what());
  }
  return 0;
}

PetscErrorCode apply_system(Mat shell, Vec v, Vec result) {
  ReducedSystem *system = nullptr;
  PetscFunctionBeginUser;
  PetscCall(MatShellGetContext(shell, &system));
  PetscCall(reported(PETSC_COMM_SELF, [&] {
    RBVI_CALL(VecCopy(v, system->scratch));
    system->extend(system->scratch);
    RBVI_CALL(MatMult(system->a, system->scratch, result));
    system->reduce(result);
  }));
  PetscFunctionReturn(0);
}

PetscErrorCode apply_preconditioner(PC pc, Vec r, Vec result) {
  ReducedSystem *system = nullptr;
  PetscFunctionBeginUser;
  PetscCall(PCShellGetContext(pc, &system));
  PetscCall(reported(PETSC_COMM_SELF, [&] {
    solve_linear(system->factor, r, result);
    system->zero_pivots(result);
  }));
  PetscFunctionReturn(0);
}

} // namespace

int solve_reduced(ReducedSystem &system, const Krylov &how, Vec right, Vec v) {
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(v));
  PetscInt local = 0;
  RBVI_CALL(VecGetLocalSize(v, &local));
  Handle<Mat> shell;
  RBVI_CALL(
      MatCreateShell(comm, local, local, PETSC_DETERMINE, PETSC_DETERMINE, &system, shell.put()));
  RBVI_CALL(
      MatShellSetOperation(shell.get(), MATOP_MULT, reinterpret_cast<void (*)()>(apply_system)));
  Handle<KSP> ksp;
  PC pc = nullptr;
  RBVI_CALL(KSPCreate(comm, ksp.put()));
  RBVI_CALL(KSPSetOptionsPrefix(ksp.get(), "hf_krylov_"));
  RBVI_CALL(KSPSetType(ksp.get(), how.symmetric ? KSPCG : KSPGMRES));
  if (!how.symmetric) RBVI_CALL(KSPGMRESSetRestart(ksp.get(), 100));
  RBVI_CALL(KSPSetNormType(ksp.get(), KSP_NORM_UNPRECONDITIONED));
  if (!how.symmetric) RBVI_CALL(KSPSetPCSide(ksp.get(), PC_RIGHT));
  RBVI_CALL(KSPSetOperators(ksp.get(), shell.get(), shell.get()));
  // Where the right-hand side is small the last solution can be far off: that is no divergence.
  constexpr double any = 1e300;
  RBVI_CALL(KSPSetTolerances(ksp.get(), how.relative, how.absolute, any, how.most_steps));
  RBVI_CALL(KSPSetInitialGuessNonzero(ksp.get(), PETSC_TRUE));
  RBVI_CALL(KSPGetPC(ksp.get(), &pc));
  RBVI_CALL(PCSetType(pc, PCSHELL));
  RBVI_CALL(PCShellSetContext(pc, &system));
  RBVI_CALL(PCShellSetApply(pc, apply_preconditioner));
  RBVI_CALL(KSPSetFromOptions(ksp.get()));
  RBVI_CALL(KSPSolve(ksp.get(), right, v));
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  PetscInt steps = 0;
  RBVI_CALL(KSPGetConvergedReason(ksp.get(), &reason));
  RBVI_CALL(KSPGetIterationNumber(ksp.get(), &steps));
  if (reason == KSP_DIVERGED_ITS || reason == KSP_DIVERGED_INDEFINITE_PC) return how.most_steps + 1;
  if (reason < 0)
    throw failure(std::string("the system of the active set was not solved (") +
                  KSPConvergedReasons[reason] + ", " + std::to_string(steps) + " steps)");
  return static_cast<int>(steps);
}

} // namespace rbvi
