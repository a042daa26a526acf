// Dense products of distributed columns: this rank's rows as Eigen matrices.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/petsc.hpp"

namespace rbvi {

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

/// X^T A Y, on every rank. Collective.
inline Matrix projected(Mat x, Mat a, Mat y) {
  Handle<Mat> product;
  RBVI_CALL(MatMatMult(a, y, MAT_INITIAL_MATRIX, PETSC_DEFAULT, product.put()));
  Matrix full = BorrowedRows(x).rows().transpose() * BorrowedRows(product.get()).rows();
  over_ranks(PetscObjectComm(reinterpret_cast<PetscObject>(a)), MPI_SUM, full);
  return full;
}

} // namespace rbvi
