#include "elimination.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/linear.hpp"
#include "rbvi/solve/vectors.hpp"

#include <array>
#include <numeric>
#include <string>

namespace rbvi {

namespace {

/// The number of this rank's first constraint, and of all of them.
std::array<Index, 2> first_and_all(MPI_Comm comm, Index own) {
  const std::vector<PetscInt> counts =
      gather_all(comm, std::vector<PetscInt>{static_cast<PetscInt>(own)}, MPIU_INT);
  const auto mine = counts.begin() + rank_of(comm);
  return {std::accumulate(counts.begin(), mine, Index{0}),
          std::accumulate(counts.begin(), counts.end(), Index{0})};
}

std::vector<Index> all_pivots(MPI_Comm comm, const std::vector<Index> &own) {
  const std::vector<PetscInt> all =
      gather_all(comm, std::vector<PetscInt>(own.begin(), own.end()), MPIU_INT);
  return {all.begin(), all.end()};
}

/// From displacements to the values of the constraints.
Handle<VecScatter> scatter_to_pivots(MPI_Comm comm, const std::vector<PetscInt> &pivots, Vec u,
                                     Vec values) {
  PetscInt first = 0;
  RBVI_CALL(VecGetOwnershipRange(values, &first, nullptr));
  const auto count = static_cast<PetscInt>(pivots.size());
  Handle<IS> from, to;
  RBVI_CALL(ISCreateGeneral(comm, count, pivots.data(), PETSC_USE_POINTER, from.put()));
  RBVI_CALL(ISCreateStride(comm, count, first, 1, to.put()));
  Handle<VecScatter> scatter;
  RBVI_CALL(VecScatterCreate(u, from.get(), values, to.get(), scatter.put()));
  return scatter;
}

/// The whole matrix, and where its two parts are in vectors.
struct Saddle {
  Handle<Mat> matrix;
  Handle<Mat> blocks; ///< owns the two index sets
  std::array<IS, 2> parts{};
};

Saddle assembled(MPI_Comm comm, Mat a, Mat w, Mat c) {
  Handle<Mat> reactions;
  RBVI_CALL(MatTranspose(w, MAT_INITIAL_MATRIX, reactions.put()));
  const std::array<Mat, 4> blocks{a, reactions.get(), c, nullptr};
  Saddle saddle;
  RBVI_CALL(MatCreateNest(comm, 2, nullptr, 2, nullptr, blocks.data(), saddle.blocks.put()));
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

Elimination::Elimination(const DualLayout &layout, const SparseMatrix &c,
                         const std::vector<Index> &pivots, const SparseMatrix &moves)
    : comm_(layout.comm), contact_dofs_(c.cols()), c_(distribute_rows(layout, c)) {
  const auto [first, all] = first_and_all(comm_, c.rows());
  first_ = first;
  count_ = all;
  for (const Index dof : pivots)
    pivots_.push_back(layout.columns[dof]);
  Handle<Vec> u;
  RBVI_CALL(MatCreateVecs(c_.get(), u.put(), values_.put()));
  to_pivots_ = scatter_to_pivots(comm_, pivots_, u.get(), values_.get());
  SparseMatrix t(c.rows(), c.cols());
  for (Index k = 0; k < t.rows(); ++k) {
    t.startVec(k);
    for (SparseMatrix::InnerIterator entry(moves, pivots[k]); entry; ++entry)
      t.insertBack(k, entry.col()) = entry.value();
  }
  t.finalize();
  t_ = distribute_rows(layout, t);
  separate_ = is_separate(layout, c * SparseMatrix(moves.transpose()), pivots);
  if (separate_) {
    collectively(comm_, [&] { block_ = PivotBlock(c, pivots, moves); });
    return;
  }
  std::vector<Index> numbers(pivots.size());
  std::iota(numbers.begin(), numbers.end(), first_);
  block_ = PivotBlock(gather_rows(comm_, c, numbers, count_), all_pivots(comm_, pivots), moves);
}

/// Whether no rank's constraints see a pivot of another.
bool Elimination::is_separate(const DualLayout &layout, const SparseMatrix &moved,
                              const std::vector<Index> &pivots) const {
  if (ranks_of(comm_) == 1) return true;
  std::vector<PetscInt> owner(layout.columns.size(), 0);
  const auto self = static_cast<PetscInt>(rank_of(comm_) + 1);
  for (const Index dof : pivots)
    owner[dof] = self;
  over_ranks(comm_, MPI_MAX, owner);
  std::array<PetscInt, 1> shared{0};
  for (Index row = 0; row < moved.rows(); ++row)
    for (SparseMatrix::InnerIterator entry(moved, row); entry; ++entry)
      if (const PetscInt of = owner[entry.col()]; entry.value() != 0 && of != 0 && of != self)
        shared.front() = 1;
  over_ranks(comm_, MPI_MAX, shared);
  return shared.front() == 0;
}

/// solve() of all constraints where they are whole, of this rank's else.
template <class Solve> Vector Elimination::solved(const Vector &own, Solve &&solve) const {
  if (separate_) return own.size() > 0 ? Vector(solve(own)) : own;
  const std::vector<double> all =
      gather_all(comm_, std::vector<double>(own.begin(), own.end()), MPI_DOUBLE);
  const Vector whole = solve(Eigen::Map<const Vector>(all.data(), std::ssize(all)));
  return whole.segment(first_, own.size());
}

Vector Elimination::at_pivots(Vec u) const {
  RBVI_CALL(VecScatterBegin(to_pivots_.get(), u, values_.get(), INSERT_VALUES, SCATTER_FORWARD));
  RBVI_CALL(VecScatterEnd(to_pivots_.get(), u, values_.get(), INSERT_VALUES, SCATTER_FORWARD));
  return LocalValues(values_.get()).get();
}

void Elimination::set_pivots(const Vector &values, Vec u) const {
  LocalValues(values_.get()).get() = values;
  RBVI_CALL(VecScatterBegin(to_pivots_.get(), values_.get(), u, INSERT_VALUES, SCATTER_REVERSE));
  RBVI_CALL(VecScatterEnd(to_pivots_.get(), values_.get(), u, INSERT_VALUES, SCATTER_REVERSE));
}

void Elimination::extend(const Vector &right, Vec u) const {
  set_pivots(Vector::Zero(right.size()), u);
  RBVI_CALL(MatMult(c_.get(), u, values_.get()));
  const Vector left = right - LocalValues(values_.get()).get();
  LocalValues(values_.get()).get() =
      solved(left, [&](const Vector &all) { return block_.solve(all); });
  RBVI_CALL(MatMultTransposeAdd(t_.get(), values_.get(), u, u));
}

Vector Elimination::multipliers(Vec r) const {
  RBVI_CALL(MatMult(t_.get(), r, values_.get()));
  return solved(LocalValues(values_.get()).get(),
                [&](const Vector &all) { return block_.solve_transposed(all); });
}

void Elimination::reduce(Vec r) const {
  const Vector y = multipliers(r);
  LocalValues(values_.get()).get() = -y;
  RBVI_CALL(MatMultTransposeAdd(c_.get(), values_.get(), r, r));
  set_pivots(Vector::Zero(y.size()), r); // but for round-off
}

SparseMatrix Elimination::ties() const {
  const SparseMatrix all = block_.ties(contact_dofs_);
  return separate_ ? all : SparseMatrix(all.middleRows(first_, std::ssize(pivots_)));
}

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

Vector solve_saddle(Mat a, Mat w, Mat c, Vec f, const Vector &right, Vec u) {
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(a));
  const Saddle saddle = assembled(comm, a, w, c);
  Handle<Vec> x, b;
  RBVI_CALL(MatCreateVecs(saddle.matrix.get(), x.put(), b.put()));
  with_part(b.get(), saddle.parts[0], [&](Vec part) { RBVI_CALL(VecCopy(f, part)); });
  with_part(b.get(), saddle.parts[1], [&](Vec part) { LocalValues(part).get() = right; });
  Handle<KSP> ksp;
  PC pc = nullptr;
  RBVI_CALL(KSPCreate(comm, ksp.put()));
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
  Vector y;
  with_part(x.get(), saddle.parts[1], [&](Vec part) { y = LocalValues(part).get(); });
  return y;
}

} // namespace rbvi
