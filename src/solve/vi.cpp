#include "rbvi/core/error.hpp"
#include "rbvi/solve/methods.hpp"

namespace rbvi {

namespace {

struct PrimalProblem {
  Mat a;
  Vec f;
};

PetscErrorCode residual(SNES, Vec u, Vec r, void *context) {
  const auto *problem = static_cast<PrimalProblem *>(context);
  PetscFunctionBeginUser;
  PetscCall(MatMult(problem->a, u, r));
  PetscCall(VecAXPY(r, -1, problem->f));
  PetscFunctionReturn(0);
}

/// Constant, but filled again at every step: the semismooth variant scales its rows in place.
PetscErrorCode jacobian(SNES, Vec, Mat, Mat tangent, void *context) {
  return MatCopy(static_cast<PrimalProblem *>(context)->a, tangent, SAME_NONZERO_PATTERN);
}

PetscErrorCode energy(SNES, Vec u, PetscReal *value, void *context) {
  const auto *problem = static_cast<PrimalProblem *>(context);
  PetscFunctionBeginUser;
  Vec scratch = nullptr;
  PetscScalar quadratic = 0, linear = 0;
  PetscCall(VecDuplicate(u, &scratch));
  PetscCall(MatMult(problem->a, u, scratch));
  PetscCall(VecDot(u, scratch, &quadratic));
  PetscCall(VecDot(u, problem->f, &linear));
  PetscCall(VecDestroy(&scratch));
  *value = quadratic / 2 - linear;
  PetscFunctionReturn(0);
}

/// The bound of each contact dof: row i of b reads b_i u_c <= g_i.
void nodal_bounds(const Trace &trace, const Operators &op, Vec lower, Vec upper) {
  RBVI_CALL(VecSet(lower, PETSC_NINFINITY));
  RBVI_CALL(VecSet(upper, PETSC_INFINITY));
  Vector low = Vector::Constant(trace.size, PETSC_NINFINITY);
  Vector high = Vector::Constant(trace.size, PETSC_INFINITY);
  for (Index i = 0; i < op.b.rows(); ++i)
    for (SparseMatrix::InnerIterator entry(op.b, i); entry; ++entry) {
      if (entry.value() == 0) continue;
      if (entry.col() != i)
        throw bad_input(
            "vi needs a bound at each node: set -lumped yes, or use -hf_method active_set");
      (entry.value() < 0 ? low : high)[entry.col()] = op.g[i] / entry.value();
    }
  PetscScalar *l = nullptr, *h = nullptr;
  RBVI_CALL(VecGetArray(lower, &l));
  RBVI_CALL(VecGetArray(upper, &h));
  for (std::size_t k = 0; k < trace.index.size(); ++k) {
    l[trace.local_row[k]] = low[trace.index[k]];
    h[trace.local_row[k]] = high[trace.index[k]];
  }
  RBVI_CALL(VecRestoreArray(lower, &l));
  RBVI_CALL(VecRestoreArray(upper, &h));
}

/// lambda_i = (F - A u)_i / b_ii, zero where the node is free.
Vector recover_multiplier(const Trace &trace, const Operators &op, Vec u) {
  Handle<Vec> r;
  RBVI_CALL(VecDuplicate(u, r.put()));
  RBVI_CALL(MatMult(op.a, u, r.get()));
  RBVI_CALL(VecAYPX(r.get(), -1, op.f));
  const Vector reaction = restrict_to(trace, r.get()), trace_u = restrict_to(trace, u);
  Vector lambda = Vector::Zero(op.b.rows());
  for (Index i = 0; i < lambda.size(); ++i) {
    const double diagonal = op.b.coeff(i, i), bound = op.g[i] / diagonal;
    const double scale = std::max(std::abs(bound), op.nodal_gap.cwiseAbs().maxCoeff());
    if (std::abs(trace_u[i] - bound) <= 1e-12 * scale)
      lambda[i] = std::max(0.0, reaction[i] / diagonal);
  }
  return lambda;
}

} // namespace

MethodResult solve_vi(const Problem &problem, const Operators &op) {
  MethodResult result;
  RBVI_CALL(VecDuplicate(op.f, result.u.put()));
  RBVI_CALL(VecZeroEntries(result.u.get()));
  Handle<Vec> lower, upper, r;
  RBVI_CALL(VecDuplicate(op.f, lower.put()));
  RBVI_CALL(VecDuplicate(op.f, upper.put()));
  RBVI_CALL(VecDuplicate(op.f, r.put()));
  nodal_bounds(problem.trace(), op, lower.get(), upper.get());

  PrimalProblem context{op.a, op.f};
  Handle<SNES> snes;
  RBVI_CALL(SNESCreate(problem.comm(), snes.put()));
  RBVI_CALL(SNESSetOptionsPrefix(snes.get(), "vi_"));
  RBVI_CALL(SNESSetType(snes.get(), SNESVINEWTONRSLS));
  RBVI_CALL(SNESSetFunction(snes.get(), r.get(), residual, &context));
  Handle<Mat> tangent;
  RBVI_CALL(MatDuplicate(op.a, MAT_COPY_VALUES, tangent.put()));
  RBVI_CALL(SNESSetJacobian(snes.get(), tangent.get(), tangent.get(), jacobian, &context));
  RBVI_CALL(SNESSetTolerances(snes.get(), 1e-14, 1e-12, 0, 200, PETSC_DEFAULT));
  KSP ksp = nullptr;
  PC pc = nullptr;
  RBVI_CALL(SNESGetKSP(snes.get(), &ksp));
  RBVI_CALL(KSPSetType(ksp, KSPPREONLY));
  RBVI_CALL(KSPGetPC(ksp, &pc));
  RBVI_CALL(PCSetType(pc, PCLU));
  RBVI_CALL(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  RBVI_CALL(SNESSetFromOptions(snes.get()));
  // The energy measures progress where iterates are feasible; the semismooth method leaves the
  // bounds on its way and has a merit function of its own.
  PetscBool semismooth = PETSC_FALSE;
  RBVI_CALL(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(snes.get()), SNESVINEWTONSSLS,
                                   &semismooth));
  if (semismooth == PETSC_FALSE) RBVI_CALL(SNESSetObjective(snes.get(), energy, &context));
  RBVI_CALL(SNESVISetVariableBounds(snes.get(), lower.get(), upper.get()));
  RBVI_CALL(SNESSolve(snes.get(), nullptr, result.u.get()));

  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  PetscInt iterations = 0;
  RBVI_CALL(SNESGetConvergedReason(snes.get(), &reason));
  RBVI_CALL(SNESGetIterationNumber(snes.get(), &iterations));
  result.iterations = static_cast<int>(iterations);
  result.converged = reason > 0;
  result.reason =
      std::string("SNES: ") + SNESConvergedReasons[reason] +
      (reason > 0 ? "" : ": try -vi_snes_max_it, another -vi_snes_type, or -hf_method active_set");
  result.lambda = recover_multiplier(problem.trace(), op, result.u.get());
  for (Index i = 0; i < result.lambda.size(); ++i)
    if (result.lambda[i] > 0) result.active.push_back(i);
  return result;
}

} // namespace rbvi
