#include "rbvi/solve/response_solver.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/node_memory.hpp"
#include "rbvi/solve/linear.hpp"

#include <algorithm>
#include <cmath>

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

/// All of `a`, sequential; on one rank `a` itself. Collective.
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

} // namespace

double plane_solve_bytes(double dofs) {
  // Nested dissection gives a factor of about 31 n log2 n entries. All that a process held beyond
  // the 64 MB without a mesh was, in units of 8 n log2 n bytes, for `rbvi solve` 18, 23 and 23 on
  // membrane_obstacle refined once, twice and three times (13e3, 53e3, 213e3 dofs) and 32 on
  // rigid_disk refined twice (91e3); in sweeps 25 on the membrane and 42 on the disk refined twice,
  // its condensed operator included. A condensed operator of thousands of multipliers comes on top:
  // 98 on the membrane refined twice with -hf_contact condensed. Multigrid takes less.
  constexpr double units = 42;
  const double n = std::max(2.0, dofs);
  return 8 * units * n * std::log2(n);
}

bool factors_fit(MPI_Comm comm, PetscInt dofs) {
  constexpr double part_of_memory = 0.5;
  if (ranks_of(comm) == 1) return true;
  const NodeMemory node = tightest_node(comm);
  return plane_solve_bytes(dofs) * node.ranks <= part_of_memory * node.bytes;
}

ResponseSolver::ResponseSolver(Mat a, const Trace &trace, const char *prefix, Factors factors)
    : comm_(trace.comm), trace_(trace) {
  const PetscInt *first_rows = nullptr;
  RBVI_CALL(MatGetLocalSize(a, &local_rows_, nullptr));
  RBVI_CALL(MatGetOwnershipRanges(a, &first_rows));
  first_rows_.assign(first_rows, first_rows + ranks_of(comm_) + 1);
  shared_ = factors == Factors::shared ||
            (factors == Factors::automatic && !factors_fit(comm_, first_rows_.back()));
  if (shared_) {
    RBVI_CALL(PetscObjectReference(reinterpret_cast<PetscObject>(a)));
    a_ = Handle<Mat>(a);
  } else {
    a_ = whole_matrix(a, comm_);
    rows_ = global_rows(trace, first_rows[rank_of(comm_)]);
  }
  RBVI_CALL(MatSetOption(a_.get(), MAT_SPD, PETSC_TRUE));
  ksp_ = make_direct_solver(PetscObjectComm(reinterpret_cast<PetscObject>(a_.get())), prefix);
  set_operator(ksp_.get(), a_.get(), Ordering::automatic);
  RBVI_CALL(KSPSetUp(ksp_.get())); // here a failure is that of every rank
}

void ResponseSolver::set(Mat a) {
  if (shared_ || ranks_of(comm_) == 1) {
    RBVI_CALL(PetscObjectReference(reinterpret_cast<PetscObject>(a)));
    a_ = Handle<Mat>(a);
  } else {
    Mat whole = a_.get();
    RBVI_CALL(
        MatCreateRedundantMatrix(a, ranks_of(comm_), MPI_COMM_NULL, MAT_REUSE_MATRIX, &whole));
  }
  RBVI_CALL(MatSetOption(a_.get(), MAT_SPD, PETSC_TRUE));
  set_operator(ksp_.get(), a_.get(), Ordering::automatic);
  RBVI_CALL(KSPSetUp(ksp_.get()));
}

/// A^-1 `right`, both dense with the row layout of A. Collective on its communicator.
void ResponseSolver::solve(Mat right, Mat solution) {
  RBVI_CALL(KSPMatSolve(ksp_.get(), right, solution));
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  RBVI_CALL(KSPGetConvergedReason(ksp_.get(), &reason));
  if (reason < 0)
    throw failure(std::string("the matrix could not be factorised (") +
                  KSPConvergedReasons[reason] + "): it must be symmetric positive definite");
}

Matrix ResponseSolver::solve_columns(const Matrix &loads, Index first, Index count) {
  PetscInt size = 0;
  RBVI_CALL(MatGetSize(a_.get(), &size, nullptr));
  Matrix right = Matrix::Zero(size, count), solution(size, count);
  for (Index k = 0; k < count; ++k)
    for (std::size_t i = 0; i < rows_.size(); ++i)
      right(rows_[i], k) += loads(static_cast<Index>(i), first + k);
  Handle<Mat> rhs, x;
  const MPI_Comm alone = PetscObjectComm(reinterpret_cast<PetscObject>(a_.get()));
  const auto columns = static_cast<PetscInt>(count);
  RBVI_CALL(MatCreateDense(alone, size, columns, size, columns, right.data(), rhs.put()));
  RBVI_CALL(MatCreateDense(alone, size, columns, size, columns, solution.data(), x.put()));
  for (Mat dense : {rhs.get(), x.get()}) {
    RBVI_CALL(MatAssemblyBegin(dense, MAT_FINAL_ASSEMBLY));
    RBVI_CALL(MatAssemblyEnd(dense, MAT_FINAL_ASSEMBLY));
  }
  solve(rhs.get(), x.get());
  return solution;
}

Matrix ResponseSolver::responses(const Matrix &loads) {
  Matrix result = Matrix::Zero(loads.rows(), loads.cols());
  if (shared_) {
    for (Index first = 0; first < loads.cols(); first += block) {
      const Index count = std::min(block, loads.cols() - first);
      const Handle<Mat> solution = dense_fields(count);
      solve_shared(loads.middleCols(first, count), solution.get());
      result.middleCols(first, count) = restrict(solution.get());
    }
    return result;
  }
  const Share mine = my_share(comm_, loads.cols());
  for (Index done = 0; done < mine.count; done += block) {
    const Index count = std::min(block, mine.count - done);
    result.middleCols(mine.first + done, count) =
        solve_columns(loads, mine.first + done, count)(rows_, Eigen::all);
  }
  over_ranks(comm_, MPI_SUM, result);
  return result;
}

void ResponseSolver::solve_shared(const Matrix &loads, Mat solution) {
  const Handle<Mat> right = extension(trace_, loads, a_.get());
  solve(right.get(), solution);
}

/// With the row layout of A, values not set.
Handle<Mat> ResponseSolver::dense_fields(Index columns) const {
  Handle<Mat> result;
  RBVI_CALL(MatCreateDense(comm_, local_rows_, PETSC_DECIDE, first_rows_.back(),
                           static_cast<PetscInt>(columns), nullptr, result.put()));
  RBVI_CALL(MatAssemblyBegin(result.get(), MAT_FINAL_ASSEMBLY));
  RBVI_CALL(MatAssemblyEnd(result.get(), MAT_FINAL_ASSEMBLY));
  return result;
}

/// `mine`: this rank's columns, all rows. Its rows of the columns of all ranks, into `values`.
/// Collective.
void ResponseSolver::exchange_rows(const Matrix &mine, Index columns, double *values,
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

Handle<Mat> ResponseSolver::fields(const Matrix &loads) {
  Handle<Mat> result = dense_fields(loads.cols());
  PetscInt stride = 0;
  RBVI_CALL(MatDenseGetLDA(result.get(), &stride));
  for (Index first = 0; first < loads.cols(); first += block) {
    const Matrix part = loads.middleCols(first, std::min(block, loads.cols() - first));
    if (shared_) {
      Mat columns = nullptr;
      const auto begin = static_cast<PetscInt>(first);
      RBVI_CALL(MatDenseGetSubMatrix(result.get(), PETSC_DECIDE, PETSC_DECIDE, begin,
                                     begin + static_cast<PetscInt>(part.cols()), &columns));
      solve_shared(part, columns);
      RBVI_CALL(MatDenseRestoreSubMatrix(result.get(), &columns));
      continue;
    }
    const Share mine = my_share(comm_, part.cols());
    const Matrix solved = mine.count > 0 ? solve_columns(part, mine.first, mine.count)
                                         : Matrix(first_rows_.back(), 0);
    double *values = nullptr;
    RBVI_CALL(MatDenseGetArray(result.get(), &values));
    exchange_rows(solved, part.cols(), values + first * stride, stride);
    RBVI_CALL(MatDenseRestoreArray(result.get(), &values));
  }
  return result;
}

} // namespace rbvi
