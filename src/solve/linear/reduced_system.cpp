#include "reduced_system.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/solve/linear/linear.hpp"
#include "rbvi/solve/linear/vectors.hpp"

#include <string>

namespace rbvi {

void set_zero(const Trace &dofs, Vec v) {
  LocalValues values(v);
  for (const PetscInt row : dofs.local_row)
    values.get()[row] = 0;
}

ReducedSystem::ReducedSystem(const Trace &trace, Mat stiffness, const Elimination &of_constraints,
                             const Elimination &of_forces, const std::vector<Index> &given_up,
                             KSP preconditioner)
    : a(stiffness), z(of_constraints), w(of_forces), pivots(part_of(trace, given_up)),
      coupled_by_z(part_of(trace, z.coupled())), coupled_by_w(part_of(trace, w.coupled())),
      factor(preconditioner) {
  RBVI_CALL(MatCreateVecs(a, nullptr, scratch.put()));
}

void ReducedSystem::extend(Vec v) const {
  if (pivots.size == 0) return;
  const Vector values = z.pivot_values(Vector::Zero(pivots.size), restrict_to(coupled_by_z, v));
  add_extension(pivots, values, v);
}

void ReducedSystem::reduce(Vec r) const {
  if (pivots.size == 0) return;
  add_extension(coupled_by_w, w.carried_over(restrict_to(pivots, r)), r);
  set_zero(pivots, r);
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
    RBVI_CALL(VecCopy(v, system->scratch.get()));
    system->extend(system->scratch.get());
    RBVI_CALL(MatMult(system->a, system->scratch.get(), result));
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
    set_zero(system->pivots, result);
  }));
  PetscFunctionReturn(0);
}

} // namespace

int solve_reduced(ReducedSystem &system, const Krylov &how, Vec right, Vec v) {
  const MPI_Comm comm = system.pivots.comm;
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
