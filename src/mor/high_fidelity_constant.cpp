#include "rbvi/mor/high_fidelity_constant.hpp"

#include "rbvi/core/error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace rbvi {

namespace {

/// [V B^T; B 0], with the zeros of its diagonal, and [0 0; 0 W].
struct SaddlePencil {
  Handle<Mat> k, m;
};

SaddlePencil saddle_pencil(MPI_Comm comm, Mat v, Mat b, Mat b_transposed, Mat w) {
  Handle<Mat> zeros, nested_k, nested_m;
  RBVI_CALL(MatDuplicate(w, MAT_DO_NOT_COPY_VALUES, zeros.put()));
  const std::array<Mat, 4> of_k{v, b_transposed, b, zeros.get()},
      of_m{nullptr, nullptr, nullptr, w};
  std::array<IS, 2> parts{};
  RBVI_CALL(MatCreateNest(comm, 2, nullptr, 2, nullptr, of_k.data(), nested_k.put()));
  RBVI_CALL(MatNestGetISs(nested_k.get(), parts.data(), nullptr));
  RBVI_CALL(MatCreateNest(comm, 2, parts.data(), 2, parts.data(), of_m.data(), nested_m.put()));
  SaddlePencil pencil;
  RBVI_CALL(MatConvert(nested_k.get(), MATAIJ, MAT_INITIAL_MATRIX, pencil.k.put()));
  RBVI_CALL(MatConvert(nested_m.get(), MATAIJ, MAT_INITIAL_MATRIX, pencil.m.put()));
  RBVI_CALL(MatSetOption(pencil.k.get(), MAT_SYMMETRIC, PETSC_TRUE));
  return pencil;
}

/// Inside ST symmetric factors by MUMPS, with room for the pivots that zeros of a diagonal delay.
void factorise(EPS eps, Mat matrix) {
  constexpr PetscInt more_room = 14, percent = 500;
  ST st = nullptr;
  KSP ksp = nullptr;
  PC pc = nullptr;
  Mat factor = nullptr;
  RBVI_CALL(EPSGetST(eps, &st));
  RBVI_CALL(STGetKSP(st, &ksp));
  RBVI_CALL(KSPSetType(ksp, KSPPREONLY));
  RBVI_CALL(KSPSetOperators(ksp, matrix, matrix));
  RBVI_CALL(KSPGetPC(ksp, &pc));
  RBVI_CALL(PCSetType(pc, PCCHOLESKY));
  RBVI_CALL(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  RBVI_CALL(PCFactorSetUpMatSolverType(pc));
  RBVI_CALL(PCFactorGetMatrix(pc, &factor));
  RBVI_CALL(MatMumpsSetIcntl(factor, more_room, percent));
}

/// The size of the eigenvalue of a x = lambda m x that `eps` finds first.
double eigenvalue(EPS eps, Mat a, Mat m, const std::string &of) {
  RBVI_CALL(EPSSetOperators(eps, a, m));
  RBVI_CALL(EPSSolve(eps));
  PetscInt converged = 0;
  double value = 0;
  RBVI_CALL(EPSGetConverged(eps, &converged));
  if (converged > 0) RBVI_CALL(EPSGetEigenvalue(eps, 0, &value, nullptr));
  if (!(value < 0))
    throw failure("the iteration for " + of +
                  " did not converge: raise -infsup_eps_max_it or -infsup_eps_tol");
  return -value;
}

} // namespace

Handle<EPS> make_infsup_eps(MPI_Comm comm, PetscInt multipliers) {
  constexpr double tolerance = 1e-12; // relative, of 1 / beta^2 and c^2
  constexpr PetscInt most_restarts = 200;
  Handle<EPS> eps;
  RBVI_CALL(EPSCreate(comm, eps.put()));
  RBVI_CALL(EPSSetOptionsPrefix(eps.get(), "infsup_"));
  RBVI_CALL(EPSSetProblemType(eps.get(), EPS_GHEP));
  RBVI_CALL(EPSSetType(eps.get(), EPSKRYLOVSCHUR));
  RBVI_CALL(EPSSetTolerances(eps.get(), tolerance, most_restarts));
  // The values of two bodies cluster: 16 vectors, the default, do not suffice.
  RBVI_CALL(EPSSetDimensions(eps.get(), 1, std::min<PetscInt>(multipliers, 64), PETSC_DEFAULT));
  RBVI_CALL(EPSSetFromOptions(eps.get()));
  return eps;
}

PairConstants iterated_constants(KSP v, Mat b, Mat w) {
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(v));
  PetscInt multipliers = 0;
  Mat product = nullptr;
  Handle<Mat> transposed, schur;
  RBVI_CALL(MatGetSize(b, &multipliers, nullptr));
  RBVI_CALL(KSPGetOperators(v, &product, nullptr));
  RBVI_CALL(MatTranspose(b, MAT_INITIAL_MATRIX, transposed.put()));
  const SaddlePencil pencil = saddle_pencil(comm, product, b, transposed.get(), w);
  const Handle<EPS> smallest = make_infsup_eps(comm, multipliers),
                    largest = make_infsup_eps(comm, multipliers);
  ST st = nullptr;
  RBVI_CALL(EPSGetST(smallest.get(), &st));
  RBVI_CALL(STSetType(st, STSINVERT));
  RBVI_CALL(EPSSetWhichEigenpairs(smallest.get(), EPS_TARGET_MAGNITUDE));
  RBVI_CALL(EPSSetTarget(smallest.get(), 0));
  factorise(smallest.get(), pencil.k.get());
  // PETSc's Schur complement has the sign of lambda above.
  RBVI_CALL(MatCreateSchurComplement(product, product, transposed.get(), b, nullptr, schur.put()));
  RBVI_CALL(MatSchurComplementSetKSP(schur.get(), v));
  RBVI_CALL(KSPSetErrorIfNotConverged(v, PETSC_TRUE));
  RBVI_CALL(EPSSetWhichEigenpairs(largest.get(), EPS_SMALLEST_REAL));
  factorise(largest.get(), w);
  return {std::sqrt(eigenvalue(smallest.get(), pencil.k.get(), pencil.m.get(), "beta_HF")),
          std::sqrt(eigenvalue(largest.get(), schur.get(), w, "c_HF"))};
}

} // namespace rbvi
