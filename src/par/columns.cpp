#include "rbvi/par/columns.hpp"

#include "rbvi/par/collective.hpp"

namespace rbvi {

Handle<Mat> make_dense(Mat like, Index columns) {
  PetscInt rows = 0, all = 0;
  RBVI_CALL(MatGetLocalSize(like, &rows, nullptr));
  RBVI_CALL(MatGetSize(like, &all, nullptr));
  Handle<Mat> dense;
  RBVI_CALL(MatCreateDense(comm_of(like), rows, PETSC_DECIDE, all, static_cast<PetscInt>(columns),
                           nullptr, dense.put()));
  RBVI_CALL(MatAssemblyBegin(dense.get(), MAT_FINAL_ASSEMBLY));
  RBVI_CALL(MatAssemblyEnd(dense.get(), MAT_FINAL_ASSEMBLY));
  return dense;
}

Handle<Mat> dense_like(Mat like, const Matrix &rows) {
  Handle<Mat> dense = make_dense(like, rows.cols());
  PetscScalar *values = nullptr;
  PetscInt stride = 0;
  RBVI_CALL(MatDenseGetLDA(dense.get(), &stride));
  RBVI_CALL(MatDenseGetArrayWrite(dense.get(), &values));
  Eigen::Map<Matrix, 0, Eigen::OuterStride<>>(values, rows.rows(), rows.cols(),
                                              Eigen::OuterStride<>(stride)) = rows;
  RBVI_CALL(MatDenseRestoreArrayWrite(dense.get(), &values));
  return dense;
}

Handle<BV> make_columns(Vec like, Index columns, Mat product) {
  Handle<BV> basis;
  RBVI_CALL(BVCreate(comm_of(like), basis.put()));
  RBVI_CALL(BVSetSizesFromVec(basis.get(), like, static_cast<PetscInt>(columns)));
  RBVI_CALL(BVSetType(basis.get(), BVMAT));
  RBVI_CALL(BVSetMatrix(basis.get(), product, PETSC_FALSE));
  return basis;
}

Matrix projected(Mat x, Mat a, Mat y) {
  Handle<Mat> product;
  RBVI_CALL(MatMatMult(a, y, MAT_INITIAL_MATRIX, PETSC_DEFAULT, product.put()));
  Matrix full = BorrowedRows(x).rows().transpose() * BorrowedRows(product.get()).rows();
  over_ranks(comm_of(a), MPI_SUM, full);
  return full;
}

Vector local_values(Vec vector) {
  PetscInt size = 0;
  const PetscScalar *values = nullptr;
  RBVI_CALL(VecGetLocalSize(vector, &size));
  RBVI_CALL(VecGetArrayRead(vector, &values));
  Vector result = Eigen::Map<const Vector>(values, size);
  RBVI_CALL(VecRestoreArrayRead(vector, &values));
  return result;
}

} // namespace rbvi
