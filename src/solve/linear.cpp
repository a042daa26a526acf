#include "rbvi/solve/linear.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/vectors.hpp"

#include <string_view>

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
  // An iterative method that an option asks for is to leave KKT residuals below their limit, 1e-10.
  RBVI_CALL(KSPSetTolerances(ksp.get(), 1e-13, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  RBVI_CALL(KSPSetFromOptions(ksp.get()));
  return ksp;
}

Handle<KSP> make_multigrid(MPI_Comm comm, const char *prefix) {
  Handle<KSP> ksp;
  PC pc = nullptr;
  RBVI_CALL(KSPCreate(comm, ksp.put()));
  RBVI_CALL(KSPSetOptionsPrefix(ksp.get(), prefix));
  RBVI_CALL(KSPGetPC(ksp.get(), &pc));
  RBVI_CALL(PCSetType(pc, PCGAMG));
  RBVI_CALL(KSPSetFromOptions(ksp.get()));
  RBVI_CALL(KSPSetType(ksp.get(), KSPPREONLY)); // once in each step of another method
  return ksp;
}

void set_operator(KSP ksp, Mat a, Ordering ordering) {
  constexpr int extra_room = 80; // per cent of its estimate; 20 by default
  constexpr int minimum_fill = 2;
  PC pc = nullptr;
  PetscBool factorises = PETSC_FALSE;
  MatSolverType type = nullptr;
  RBVI_CALL(KSPSetOperators(ksp, a, a));
  RBVI_CALL(KSPGetPC(ksp, &pc));
  RBVI_CALL(PetscObjectTypeCompareAny(reinterpret_cast<PetscObject>(pc), &factorises, PCCHOLESKY,
                                      PCLU, nullptr));
  if (factorises == PETSC_FALSE) return;
  RBVI_CALL(PCFactorGetMatSolverType(pc, &type));
  if (type == nullptr || std::string_view(type) != MATSOLVERMUMPS) return;
  const char *prefix = nullptr;
  Mat factor = nullptr;
  RBVI_CALL(KSPGetOptionsPrefix(ksp, &prefix));
  RBVI_CALL(MatSetOptionsPrefixFactor(a, prefix)); // as PCSetUp does, which comes later
  RBVI_CALL(PCFactorSetUpMatSolverType(pc));
  RBVI_CALL(PCFactorGetMatrix(pc, &factor));
  // Options for them come later, and win.
  RBVI_CALL(MatMumpsSetIcntl(factor, 14, extra_room));
  if (ordering == Ordering::minimum_fill) RBVI_CALL(MatMumpsSetIcntl(factor, 7, minimum_fill));
}

void solve_linear(KSP ksp, Vec rhs, Vec x) {
  RBVI_CALL(KSPSolve(ksp, rhs, x));
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  RBVI_CALL(KSPGetConvergedReason(ksp, &reason));
  if (reason < 0)
    throw failure(std::string("the linear solver stopped with ") + KSPConvergedReasons[reason] +
                  (reason == KSP_DIVERGED_ITS
                       ? ": allow more of them by -hf_ksp_max_it, or leave out "
                         "-hf_ksp_type for a direct solver"
                       : ": is the stiffness matrix singular?"));
}

double solve_refined(KSP ksp, Vec rhs, Vec x) {
  constexpr int most_refinements = 2;
  constexpr double enough = 1e-11;
  solve_linear(ksp, rhs, x);
  Mat a = nullptr;
  RBVI_CALL(KSPGetOperators(ksp, &a, nullptr));
  const Handle<Vec> left = like(rhs), correction = like(rhs);
  for (int pass = 0;; ++pass) {
    RBVI_CALL(MatMult(a, x, left.get()));
    RBVI_CALL(VecAYPX(left.get(), -1, rhs));
    if (norm(left.get()) <= enough * norm(rhs)) return 0;
    if (pass == most_refinements) break;
    solve_linear(ksp, left.get(), correction.get());
    RBVI_CALL(VecAXPY(x, 1, correction.get()));
  }
  return norm(correction.get()) / norm(x);
}

} // namespace rbvi
