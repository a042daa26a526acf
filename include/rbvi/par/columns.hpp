// Columns over the ranks, whose rows are distributed: dense matrices and bases.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/par/petsc.hpp"

namespace rbvi {

/// Of a PETSc or SLEPc object.
template <class Object> MPI_Comm comm_of(Object object) {
  return PetscObjectComm(reinterpret_cast<PetscObject>(object));
}

/// This rank's rows of a dense matrix, borrowed until destruction.
class BorrowedRows {
public:
  using LocalRows = Eigen::Map<const Matrix, 0, Eigen::OuterStride<>>;

  explicit BorrowedRows(Mat dense) : dense_(dense) {
    RBVI_CALL(MatGetLocalSize(dense, &rows_, nullptr));
    RBVI_CALL(MatGetSize(dense, nullptr, &columns_));
    RBVI_CALL(MatDenseGetLDA(dense, &stride_));
    RBVI_CALL(MatDenseGetArrayRead(dense, &values_));
  }
  ~BorrowedRows() { (void)MatDenseRestoreArrayRead(dense_, &values_); }
  BorrowedRows(const BorrowedRows &) = delete;
  BorrowedRows &operator=(const BorrowedRows &) = delete;
  LocalRows rows() const { return {values_, rows_, columns_, Eigen::OuterStride<>(stride_)}; }

private:
  Mat dense_;
  PetscInt rows_ = 0, columns_ = 0, stride_ = 0;
  const PetscScalar *values_ = nullptr;
};

/// The columns of a basis that are in use as a dense matrix, borrowed until destruction.
class BorrowedColumns {
public:
  explicit BorrowedColumns(BV basis) : basis_(basis) { RBVI_CALL(BVGetMat(basis, &columns_)); }
  ~BorrowedColumns() { (void)BVRestoreMat(basis_, &columns_); }
  BorrowedColumns(const BorrowedColumns &) = delete;
  BorrowedColumns &operator=(const BorrowedColumns &) = delete;
  Mat get() const { return columns_; }

private:
  BV basis_;
  Mat columns_ = nullptr;
};

/// A dense matrix with the rows of `like`, zero. Collective.
Handle<Mat> make_dense(Mat like, Index columns);
/// Likewise; `rows`: of this rank.
Handle<Mat> dense_like(Mat like, const Matrix &rows);

/// A basis with the rows of `like`; `product`: of its columns, null: the Euclidean one. Collective.
Handle<BV> make_columns(Vec like, Index columns, Mat product);

/// X^T A Y, on every rank. Collective.
Matrix projected(Mat x, Mat a, Mat y);

/// This rank's entries.
Vector local_values(Vec vector);

} // namespace rbvi
