#include "elimination.hpp"

#include "rbvi/par/collective.hpp"
#include "rbvi/par/gather.hpp"
#include "rbvi/solve/vectors.hpp"

#include <array>
#include <numeric>

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

} // namespace rbvi
