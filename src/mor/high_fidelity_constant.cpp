#include "rbvi/mor/high_fidelity_constant.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/mor/operator_entries.hpp"
#include "rbvi/solve/whole.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

namespace rbvi {

namespace {

/// A symmetric operator y = A x; returns PETSc's error code.
using Operator = std::function<PetscErrorCode(const Vector &x, Vector &y)>;

PetscErrorCode apply(Mat shell, Vec x, Vec y) {
  PetscFunctionBeginUser;
  void *context = nullptr;
  PetscCall(MatShellGetContext(shell, &context));
  PetscInt size = 0;
  const PetscScalar *from = nullptr;
  PetscScalar *to = nullptr;
  PetscCall(VecGetLocalSize(x, &size));
  PetscCall(VecGetArrayRead(x, &from));
  const Vector before = Eigen::Map<const Vector>(from, size);
  PetscCall(VecRestoreArrayRead(x, &from));
  Vector after(size);
  PetscCall((*static_cast<const Operator *>(context))(before, after));
  PetscCall(VecGetArrayWrite(y, &to));
  Eigen::Map<Vector>(to, size) = after;
  PetscCall(VecRestoreArrayWrite(y, &to));
  PetscFunctionReturn(0);
}

/// By SLEPc's EPS, prefix infsup_.
double largest_eigenvalue(Index rows, Operator a, const std::string &of) {
  const auto size = static_cast<PetscInt>(rows);
  Handle<Mat> shell;
  RBVI_CALL(MatCreateShell(PETSC_COMM_SELF, size, size, size, size, &a, shell.put()));
  RBVI_CALL(MatShellSetOperation(shell.get(), MATOP_MULT, reinterpret_cast<void (*)()>(apply)));
  const Handle<EPS> eps = make_infsup_eps(size);
  RBVI_CALL(EPSSetOperators(eps.get(), shell.get(), nullptr));
  RBVI_CALL(EPSSolve(eps.get()));
  PetscInt converged = 0;
  RBVI_CALL(EPSGetConverged(eps.get(), &converged));
  double value = 0;
  if (converged > 0) RBVI_CALL(EPSGetEigenvalue(eps.get(), 0, &value, nullptr));
  if (!(value > 0))
    throw failure("the iteration for " + of +
                  " did not converge: raise -infsup_eps_max_it or "
                  "-infsup_eps_tol");
  return value;
}

/// W = R R^T, R = P^T L.
using Root = Eigen::SimplicialLLT<Eigen::SparseMatrix<double>>;

void factorise(const SparseMatrix &w_product, Root &root) {
  root.compute(w_product);
  if (root.info() != Eigen::Success) throw failure("the W product is not positive definite");
}

/// A sequential sparse matrix whose entries visit(add) adds, add(row, column, value), of at most
/// `longest` entries a row.
template <class Visit>
Handle<Mat> assembled(PetscInt size, const std::vector<PetscInt> &longest, const Visit &visit) {
  Handle<Mat> matrix;
  RBVI_CALL(MatCreateSeqAIJ(PETSC_COMM_SELF, size, size, 0, longest.data(), matrix.put()));
  visit([&](PetscInt row, PetscInt column, double value) {
    RBVI_CALL(MatSetValue(matrix.get(), row, column, value, ADD_VALUES));
  });
  RBVI_CALL(MatAssemblyBegin(matrix.get(), MAT_FINAL_ASSEMBLY));
  RBVI_CALL(MatAssemblyEnd(matrix.get(), MAT_FINAL_ASSEMBLY));
  RBVI_CALL(MatSetOption(matrix.get(), MAT_SYMMETRIC, PETSC_TRUE));
  return matrix;
}

/// [V B^T; B 0], with the zeros of its diagonal.
Handle<Mat> saddle_point(Mat v, const SparseMatrix &b, const std::vector<PetscInt> &dofs) {
  PetscInt fields = 0;
  RBVI_CALL(MatGetSize(v, &fields, nullptr));
  const auto size = static_cast<PetscInt>(fields + b.rows());
  std::vector<PetscInt> longest(size, 1);
  const auto each_of_b = [&](const auto &visit) {
    for (Index i = 0; i < b.rows(); ++i)
      for (SparseMatrix::InnerIterator entry(b, i); entry; ++entry)
        visit(static_cast<PetscInt>(fields + i), dofs[entry.col()], entry.value());
  };
  visit_entries(v, [&](PetscInt row, PetscInt, double) { ++longest[row]; });
  each_of_b([&](PetscInt row, PetscInt column, double) {
    ++longest[row];
    ++longest[column];
  });
  return assembled(size, longest, [&](const auto &add) {
    visit_entries(v, add);
    each_of_b([&](PetscInt row, PetscInt column, double value) {
      add(row, column, value);
      add(column, row, value);
    });
    for (PetscInt row = fields; row < size; ++row)
      add(row, row, 0);
  });
}

/// An indefinite matrix, by MUMPS, with room for the pivots that the zeros of its diagonal delay.
Handle<KSP> factorised(Mat matrix) {
  constexpr PetscInt more_room = 14, percent = 500;
  Handle<KSP> ksp;
  PC pc = nullptr;
  RBVI_CALL(KSPCreate(PETSC_COMM_SELF, ksp.put()));
  RBVI_CALL(KSPSetOperators(ksp.get(), matrix, matrix));
  RBVI_CALL(KSPSetType(ksp.get(), KSPPREONLY));
  RBVI_CALL(KSPGetPC(ksp.get(), &pc));
  RBVI_CALL(PCSetType(pc, PCCHOLESKY));
  RBVI_CALL(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  Mat factor = nullptr;
  RBVI_CALL(PCFactorSetUpMatSolverType(pc));
  RBVI_CALL(PCFactorGetMatrix(pc, &factor));
  RBVI_CALL(MatMumpsSetIcntl(factor, more_room, percent));
  RBVI_CALL(KSPSetErrorIfNotConverged(ksp.get(), PETSC_TRUE));
  RBVI_CALL(KSPSetUp(ksp.get()));
  return ksp;
}

} // namespace

Handle<EPS> make_infsup_eps(PetscInt size) {
  constexpr double tolerance = 1e-12; // relative, of 1 / beta^2 and c^2
  constexpr PetscInt most_restarts = 200;
  Handle<EPS> eps;
  RBVI_CALL(EPSCreate(PETSC_COMM_SELF, eps.put()));
  RBVI_CALL(EPSSetOptionsPrefix(eps.get(), "infsup_"));
  RBVI_CALL(EPSSetProblemType(eps.get(), EPS_HEP));
  RBVI_CALL(EPSSetType(eps.get(), EPSKRYLOVSCHUR));
  RBVI_CALL(EPSSetTolerances(eps.get(), tolerance, most_restarts));
  // The values of two bodies cluster: 16 vectors, the default, do not suffice.
  RBVI_CALL(EPSSetDimensions(eps.get(), 1, std::min<PetscInt>(size, 64), PETSC_DEFAULT));
  RBVI_CALL(EPSSetFromOptions(eps.get()));
  RBVI_CALL(EPSSetWhichEigenpairs(eps.get(), EPS_LARGEST_REAL));
  return eps;
}

SparseInfSup::SparseInfSup(Mat product, const Trace &trace)
    : product_(whole_matrix(product, trace.comm)), dofs_(whole_rows(product, trace)) {}

double SparseInfSup::constant(const SparseMatrix &b_contact, const SparseMatrix &w_product) const {
  if (b_contact.rows() == 0) return std::numeric_limits<double>::infinity();
  if (b_contact.rows() > b_contact.cols()) return 0;
  Root w;
  factorise(w_product, w);
  const Handle<Mat> matrix = saddle_point(product_.get(), b_contact, dofs_);
  const Handle<KSP> ksp = factorised(matrix.get());
  Handle<Vec> right, solution;
  PetscInt fields = 0; // rows of V, in front
  RBVI_CALL(MatGetSize(product_.get(), &fields, nullptr));
  RBVI_CALL(MatCreateVecs(matrix.get(), right.put(), solution.put()));
  const Operator inverse = [&](const Vector &x, Vector &y) {
    PetscFunctionBeginUser;
    const PetscScalar *from = nullptr;
    PetscScalar *to = nullptr;
    PetscCall(VecZeroEntries(right.get()));
    PetscCall(VecGetArray(right.get(), &to));
    Eigen::Map<Vector>(to + fields, x.size()) = w.permutationPinv() * (w.matrixL() * x).eval();
    PetscCall(VecRestoreArray(right.get(), &to));
    PetscCall(KSPSolve(ksp.get(), right.get(), solution.get()));
    PetscCall(VecGetArrayRead(solution.get(), &from));
    y = w.permutationP() * Eigen::Map<const Vector>(from + fields, x.size());
    y = -(w.matrixU() * y).eval();
    PetscCall(VecRestoreArrayRead(solution.get(), &from));
    PetscFunctionReturn(0);
  };
  return 1 / std::sqrt(largest_eigenvalue(b_contact.rows(), inverse, "beta_HF"));
}

double largest_stretch(const Matrix &riesz_factor, const SparseMatrix &b_contact,
                       const SparseMatrix &w_product) {
  if (b_contact.rows() == 0) return 0;
  Root w;
  factorise(w_product, w);
  const auto lower = riesz_factor.triangularView<Eigen::Lower>();
  const Operator square = [&](const Vector &x, Vector &y) {
    const Vector eta = w.permutationPinv() * w.matrixU().solve(x);
    const Vector representer = lower.transpose() * (b_contact.transpose() * eta).eval();
    y = w.permutationP() * (b_contact * (lower * representer).eval());
    w.matrixL().solveInPlace(y);
    return PetscErrorCode{0};
  };
  return std::sqrt(largest_eigenvalue(b_contact.rows(), square, "c_HF"));
}

} // namespace rbvi
