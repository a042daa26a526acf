#include "saddle_system.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/par/gather.hpp"
#include "rbvi/solve/linear/linear.hpp"
#include "rbvi/solve/linear/vectors.hpp"

#include <array>

namespace rbvi {

namespace {

/// This rank's part of the constraints.
struct Constraints {
  PetscInt first = 0, count = 0;
};

Constraints own_constraints(MPI_Comm comm, Index all) {
  Constraints own;
  own.count = PETSC_DECIDE;
  auto total = static_cast<PetscInt>(all);
  RBVI_CALL(PetscSplitOwnership(comm, &own.count, &total));
  MPI_Exscan(&own.count, &own.first, 1, MPIU_INT, MPI_SUM, comm);
  return own;
}

/// An empty distributed matrix that takes entries as they come.
Handle<Mat> matrix_of(MPI_Comm comm, PetscInt rows, PetscInt columns) {
  constexpr PetscInt expected = 32; // entries of a row
  Handle<Mat> matrix;
  RBVI_CALL(MatCreateAIJ(comm, rows, columns, PETSC_DETERMINE, PETSC_DETERMINE, expected, nullptr,
                         expected, nullptr, matrix.put()));
  RBVI_CALL(MatSetOption(matrix.get(), MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
  return matrix;
}

/// The whole matrix, and where its two parts are in vectors.
struct Saddle {
  Handle<Mat> matrix;
  Handle<Mat> blocks; ///< owns the two index sets
  std::array<IS, 2> parts{};
};

Saddle assembled(const Trace &trace, Mat a, const SparseMatrix &w, const SparseMatrix &c,
                 const Constraints &own) {
  PetscInt rows = 0, first_row = 0;
  RBVI_CALL(MatGetLocalSize(a, &rows, nullptr));
  RBVI_CALL(MatGetOwnershipRange(a, &first_row, nullptr));
  const std::vector<PetscInt> row_of = global_rows(trace, first_row);
  const Handle<Mat> reactions = matrix_of(trace.comm, rows, own.count);
  const Handle<Mat> conditions = matrix_of(trace.comm, own.count, rows);
  const SparseMatrix by_dof = w.transpose();
  for (std::size_t k = 0; k < trace.index.size(); ++k)
    for (SparseMatrix::InnerIterator entry(by_dof, trace.index[k]); entry; ++entry)
      RBVI_CALL(MatSetValue(reactions.get(), first_row + trace.local_row[k],
                            static_cast<PetscInt>(entry.col()), entry.value(), INSERT_VALUES));
  for (PetscInt i = own.first; i < own.first + own.count; ++i)
    for (SparseMatrix::InnerIterator entry(c, i); entry; ++entry)
      RBVI_CALL(MatSetValue(conditions.get(), i, row_of[static_cast<std::size_t>(entry.col())],
                            entry.value(), INSERT_VALUES));
  for (const Mat block : {reactions.get(), conditions.get()}) {
    RBVI_CALL(MatAssemblyBegin(block, MAT_FINAL_ASSEMBLY));
    RBVI_CALL(MatAssemblyEnd(block, MAT_FINAL_ASSEMBLY));
  }
  const std::array<Mat, 4> blocks{a, reactions.get(), conditions.get(), nullptr};
  Saddle saddle;
  RBVI_CALL(MatCreateNest(trace.comm, 2, nullptr, 2, nullptr, blocks.data(), saddle.blocks.put()));
  RBVI_CALL(MatNestGetISs(saddle.blocks.get(), saddle.parts.data(), nullptr));
  RBVI_CALL(MatConvert(saddle.blocks.get(), MATAIJ, MAT_INITIAL_MATRIX, saddle.matrix.put()));
  return saddle;
}

/// visit(part of the vector).
template <class Visit> void with_part(Vec whole, IS part, Visit &&visit) {
  Vec values = nullptr;
  RBVI_CALL(VecGetSubVector(whole, part, &values));
  visit(values);
  RBVI_CALL(VecRestoreSubVector(whole, part, &values));
}

} // namespace

Vector solve_saddle(const Trace &trace, Mat a, const SparseMatrix &w, const SparseMatrix &c, Vec f,
                    const Vector &right, Vec u) {
  const Constraints own = own_constraints(trace.comm, c.rows());
  const Saddle saddle = assembled(trace, a, w, c, own);
  Handle<Vec> x, b;
  RBVI_CALL(MatCreateVecs(saddle.matrix.get(), x.put(), b.put()));
  with_part(b.get(), saddle.parts[0], [&](Vec part) { RBVI_CALL(VecCopy(f, part)); });
  with_part(b.get(), saddle.parts[1],
            [&](Vec part) { LocalValues(part).get() = right.segment(own.first, own.count); });
  Handle<KSP> ksp;
  PC pc = nullptr;
  RBVI_CALL(KSPCreate(trace.comm, ksp.put()));
  RBVI_CALL(KSPSetOptionsPrefix(ksp.get(), "hf_saddle_"));
  RBVI_CALL(KSPSetType(ksp.get(), KSPPREONLY));
  RBVI_CALL(KSPGetPC(ksp.get(), &pc));
  RBVI_CALL(PCSetType(pc, PCLU));
  RBVI_CALL(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  RBVI_CALL(KSPSetFromOptions(ksp.get()));
  set_operator(ksp.get(), saddle.matrix.get(), Ordering::automatic);
  solve_linear(ksp.get(), b.get(), x.get());
  // One step of refinement; what MUMPS leaves where it fails is zero or not finite.
  constexpr double enough = 1e-9;
  const Handle<Vec> residual = like(b.get()), change = like(x.get());
  const auto set_residual = [&] {
    RBVI_CALL(MatMult(saddle.matrix.get(), x.get(), residual.get()));
    RBVI_CALL(VecAYPX(residual.get(), -1, b.get()));
  };
  set_residual();
  solve_linear(ksp.get(), residual.get(), change.get());
  RBVI_CALL(VecAXPY(x.get(), 1, change.get()));
  set_residual();
  if (!(norm(residual.get()) <= enough * norm(b.get())))
    throw failure("the system of the active set with its multipliers was solved to " +
                  short_number(norm(residual.get()) / norm(b.get())) +
                  " only: try -hf_contact condensed");
  with_part(x.get(), saddle.parts[0], [&](Vec part) { RBVI_CALL(VecCopy(part, u)); });
  std::vector<double> mine;
  with_part(x.get(), saddle.parts[1], [&](Vec part) {
    LocalValues values(part);
    mine.assign(values.get().begin(), values.get().end());
  });
  const std::vector<double> all = gather_all(trace.comm, mine, MPI_DOUBLE);
  return Eigen::Map<const Vector>(all.data(), std::ssize(all));
}

} // namespace rbvi
