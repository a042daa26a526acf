#include "rbvi/solve/linear/replicated.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/linear/linear.hpp"
#include "rbvi/solve/linear/whole.hpp"

#include <algorithm>

namespace rbvi {

namespace {

constexpr Index block = 128; ///< right-hand sides at a time: bounds the memory

struct Share {
  Index first, count;
};

/// A rank's part of 0 .. size - 1.
Share share_of(int rank, int ranks, Index size) {
  const Index first = size * rank / ranks;
  return {first, size * (rank + 1) / ranks - first};
}
Share my_share(MPI_Comm comm, Index size) {
  return share_of(rank_of(comm), ranks_of(comm), size);
}

} // namespace

Handle<Mat> whole_matrix(Mat a, MPI_Comm comm) {
  const int ranks = ranks_of(comm);
  Handle<Mat> whole;
  if (ranks == 1) {
    RBVI_CALL(PetscObjectReference(reinterpret_cast<PetscObject>(a)));
    return Handle<Mat>(a);
  }
  RBVI_CALL(MatCreateRedundantMatrix(a, ranks, MPI_COMM_NULL, MAT_INITIAL_MATRIX, whole.put()));
  return whole;
}

std::vector<PetscInt> whole_rows(Mat a, const Trace &trace) {
  PetscInt first = 0;
  RBVI_CALL(MatGetOwnershipRange(a, &first, nullptr));
  return global_rows(trace, first);
}

ReplicatedSolver::ReplicatedSolver(Mat a, const Trace &trace, const char *prefix)
    : comm_(trace.comm), trace_(trace), whole_(whole_matrix(a, trace.comm)),
      rows_(whole_rows(a, trace)) {
  const PetscInt *first_rows = nullptr;
  RBVI_CALL(MatGetLocalSize(a, &local_rows_, nullptr));
  RBVI_CALL(MatGetOwnershipRanges(a, &first_rows));
  first_rows_.assign(first_rows, first_rows + ranks_of(trace.comm) + 1);
  RBVI_CALL(MatSetOption(whole_.get(), MAT_SPD, PETSC_TRUE));
  ksp_ = make_direct_solver(PetscObjectComm(reinterpret_cast<PetscObject>(whole_.get())), prefix);
  RBVI_CALL(KSPSetOperators(ksp_.get(), whole_.get(), whole_.get()));
  RBVI_CALL(KSPSetUp(ksp_.get())); // here a failure is that of every rank
}

Matrix ReplicatedSolver::solve_columns(const Matrix &loads, Index first, Index count) {
  PetscInt size = 0;
  RBVI_CALL(MatGetSize(whole_.get(), &size, nullptr));
  Matrix right = Matrix::Zero(size, count), solution(size, count);
  for (Index k = 0; k < count; ++k)
    for (std::size_t i = 0; i < rows_.size(); ++i)
      right(rows_[i], k) += loads(static_cast<Index>(i), first + k);
  Handle<Mat> rhs, x;
  const MPI_Comm alone = PetscObjectComm(reinterpret_cast<PetscObject>(whole_.get()));
  const auto columns = static_cast<PetscInt>(count);
  RBVI_CALL(MatCreateDense(alone, size, columns, size, columns, right.data(), rhs.put()));
  RBVI_CALL(MatCreateDense(alone, size, columns, size, columns, solution.data(), x.put()));
  for (Mat dense : {rhs.get(), x.get()}) {
    RBVI_CALL(MatAssemblyBegin(dense, MAT_FINAL_ASSEMBLY));
    RBVI_CALL(MatAssemblyEnd(dense, MAT_FINAL_ASSEMBLY));
  }
  RBVI_CALL(KSPMatSolve(ksp_.get(), rhs.get(), x.get()));
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  RBVI_CALL(KSPGetConvergedReason(ksp_.get(), &reason));
  if (reason < 0)
    throw failure(std::string("the matrix could not be factorised (") +
                  KSPConvergedReasons[reason] + "): it must be symmetric positive definite");
  return solution;
}

Matrix ReplicatedSolver::responses(const Matrix &loads) {
  const Share mine = my_share(comm_, loads.cols());
  Matrix result = Matrix::Zero(loads.rows(), loads.cols());
  for (Index done = 0; done < mine.count; done += block) {
    const Index count = std::min(block, mine.count - done);
    result.middleCols(mine.first + done, count) =
        solve_columns(loads, mine.first + done, count)(rows_, Eigen::all);
  }
  over_ranks(comm_, MPI_SUM, result);
  return result;
}

/// `mine`: this rank's columns, all rows. Its rows of the columns of all ranks, into `values`.
/// Collective.
void ReplicatedSolver::exchange_rows(const Matrix &mine, Index columns, double *values,
                                     Index stride) const {
  const auto ranks = static_cast<std::size_t>(ranks_of(comm_));
  std::vector<int> sent(ranks), sent_at(ranks), received(ranks), received_at(ranks);
  Vector to(mine.size()), from(local_rows_ * columns);
  Index at = 0;
  for (std::size_t r = 0; r < ranks; ++r) {
    const Index first = first_rows_[r], rows = first_rows_[r + 1] - first;
    sent_at[r] = static_cast<int>(at);
    sent[r] = static_cast<int>(rows * mine.cols());
    for (Index k = 0; k < mine.cols(); ++k, at += rows)
      to.segment(at, rows) = mine.col(k).segment(first, rows);
    const Share theirs = share_of(static_cast<int>(r), static_cast<int>(ranks), columns);
    received_at[r] = static_cast<int>(theirs.first * local_rows_);
    received[r] = static_cast<int>(theirs.count * local_rows_);
  }
  MPI_Alltoallv(to.data(), sent.data(), sent_at.data(), MPI_DOUBLE, from.data(), received.data(),
                received_at.data(), MPI_DOUBLE, comm_);
  for (Index k = 0; k < columns; ++k)
    std::copy_n(from.data() + k * local_rows_, local_rows_, values + k * stride);
}

Handle<Mat> ReplicatedSolver::fields(const Matrix &loads) {
  PetscInt stride = 0;
  Handle<Mat> result;
  RBVI_CALL(MatCreateDense(comm_, local_rows_, PETSC_DECIDE, first_rows_.back(),
                           static_cast<PetscInt>(loads.cols()), nullptr, result.put()));
  RBVI_CALL(MatDenseGetLDA(result.get(), &stride));
  for (Index first = 0; first < loads.cols(); first += block) {
    const Matrix part = loads.middleCols(first, std::min(block, loads.cols() - first));
    const Share mine = my_share(comm_, part.cols());
    const Matrix solved = mine.count > 0 ? solve_columns(part, mine.first, mine.count)
                                         : Matrix(first_rows_.back(), 0);
    double *values = nullptr;
    RBVI_CALL(MatDenseGetArray(result.get(), &values));
    exchange_rows(solved, part.cols(), values + first * stride, stride);
    RBVI_CALL(MatDenseRestoreArray(result.get(), &values));
  }
  RBVI_CALL(MatAssemblyBegin(result.get(), MAT_FINAL_ASSEMBLY));
  RBVI_CALL(MatAssemblyEnd(result.get(), MAT_FINAL_ASSEMBLY));
  return result;
}

} // namespace rbvi
