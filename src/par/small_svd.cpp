#include "rbvi/par/small_svd.hpp"

#include "rbvi/core/error.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

namespace rbvi {

namespace {

std::map<std::string, Handle<SVD>> objects; // one for each prefix, until PETSc ends

PetscErrorCode forget_objects() {
  objects.clear();
  return 0;
}

SVD object_of(const char *prefix) {
  Handle<SVD> &svd = objects[prefix];
  if (!svd) {
    static bool registered = false;
    if (!std::exchange(registered, true)) RBVI_CALL(PetscRegisterFinalize(forget_objects));
    svd = make_small_svd(prefix);
  }
  return svd.get();
}

void solve(SVD svd, const Matrix &matrix, const std::string &prefix) {
  const auto wanted = static_cast<PetscInt>(std::min(matrix.rows(), matrix.cols()));
  RBVI_CALL(SVDSetOperators(svd, sequential_dense(matrix).get(), nullptr));
  RBVI_CALL(SVDSetDimensions(svd, wanted, PETSC_DEFAULT, PETSC_DEFAULT));
  RBVI_CALL(SVDSolve(svd));
  PetscInt converged = 0;
  RBVI_CALL(SVDGetConverged(svd, &converged));
  if (converged < wanted)
    throw failure("SLEPc returned " + std::to_string(converged) + " of " + std::to_string(wanted) +
                  " singular values of a dense matrix: check the scaling of its entries" +
                  (prefix.empty() ? "" : ", and leave out -" + prefix + "svd_type"));
}

/// LAPACK's divide and conquer gives up on some matrices, on others with another BLAS.
bool lapack_gave_up(const Error &error) {
  return std::string_view(error.what()).find("LAPACK subroutine gesdd") != std::string_view::npos;
}

/// The object of the prefix with all triplets of `matrix`; nothing where LAPACK gives up.
std::optional<SVD> solved(const Matrix &matrix, const char *prefix) {
  if (!matrix.allFinite()) throw failure("singular values of a matrix with entries not finite");
  SVD svd = object_of(prefix);
  try {
    solve(svd, matrix, prefix);
  } catch (const Error &error) {
    objects.erase(prefix); // what it was in the middle of
    if (lapack_gave_up(error)) return std::nullopt;
    throw;
  }
  return svd;
}

/// An object keeps its last matrix, the vectors and room to work, seven times the size of the
/// matrix: none is kept after a large one.
void let_go(const Matrix &matrix, const char *prefix) {
  constexpr Index large = 100000; // entries
  if (matrix.size() > large) objects.erase(prefix);
}

/// By Jacobi's rotations: slower, and they always converge.
SmallSvd by_rotations(const Matrix &matrix) {
  const Eigen::JacobiSVD<Matrix> svd(matrix, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.singularValues(), svd.matrixU(), svd.matrixV()};
}

Handle<Vec> wrapped_column(Matrix &matrix, Index column) {
  Handle<Vec> vector;
  RBVI_CALL(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, static_cast<PetscInt>(matrix.rows()),
                                  matrix.col(column).data(), vector.put()));
  return vector;
}

} // namespace

Handle<SVD> make_small_svd(const char *prefix) {
  Handle<SVD> svd;
  RBVI_CALL(SVDCreate(PETSC_COMM_SELF, svd.put()));
  RBVI_CALL(SVDSetType(svd.get(), SVDLAPACK));
  if (*prefix == '\0') return svd;
  RBVI_CALL(SVDSetOptionsPrefix(svd.get(), prefix));
  RBVI_CALL(SVDSetFromOptions(svd.get()));
  return svd;
}

Handle<Mat> sequential_dense(const Matrix &matrix) {
  Handle<Mat> copy;
  RBVI_CALL(MatCreateSeqDense(PETSC_COMM_SELF, static_cast<PetscInt>(matrix.rows()),
                              static_cast<PetscInt>(matrix.cols()), nullptr, copy.put()));
  double *entries = nullptr;
  RBVI_CALL(MatDenseGetArrayWrite(copy.get(), &entries));
  std::copy_n(matrix.data(), matrix.size(), entries);
  RBVI_CALL(MatDenseRestoreArrayWrite(copy.get(), &entries));
  RBVI_CALL(MatAssemblyBegin(copy.get(), MAT_FINAL_ASSEMBLY));
  RBVI_CALL(MatAssemblyEnd(copy.get(), MAT_FINAL_ASSEMBLY));
  return copy;
}

namespace {

/// Of a matrix with no more rows than columns, or a square one.
SmallSvd of_few_rows(const Matrix &matrix, const char *prefix) {
  const Index count = matrix.rows();
  SmallSvd result{Vector(count), Matrix(count, count), Matrix(matrix.cols(), count)};
  const std::optional<SVD> svd = solved(matrix, prefix);
  if (!svd) return by_rotations(matrix);
  for (Index k = 0; k < count; ++k) {
    const Handle<Vec> left = wrapped_column(result.left, k);
    const Handle<Vec> right = wrapped_column(result.right, k);
    RBVI_CALL(SVDGetSingularTriplet(*svd, static_cast<PetscInt>(k), &result.values(k), left.get(),
                                    right.get()));
  }
  let_go(matrix, prefix);
  return result;
}

} // namespace

SmallSvd small_svd(const Matrix &matrix, const char *prefix) {
  if (matrix.size() == 0) return {Vector(0), Matrix(matrix.rows(), 0), Matrix(matrix.cols(), 0)};
  if (matrix.rows() <= matrix.cols()) return of_few_rows(matrix, prefix);
  const auto [q, r] = thin_qr(matrix);
  SmallSvd result = of_few_rows(r, prefix);
  result.left = q * result.left;
  return result;
}

Vector singular_values(const Matrix &matrix, const char *prefix) {
  Vector values(std::min(matrix.rows(), matrix.cols()));
  if (values.size() == 0) return values;
  // A square matrix with the same singular values: LAPACK's SVD forms vectors of full length.
  const Matrix factor = matrix.rows() > matrix.cols() ? triangular_factor(matrix) : matrix;
  const std::optional<SVD> svd = solved(factor, prefix);
  if (!svd) return by_rotations(factor).values;
  for (Index k = 0; k < values.size(); ++k)
    RBVI_CALL(SVDGetSingularTriplet(*svd, static_cast<PetscInt>(k), &values(k), nullptr, nullptr));
  let_go(factor, prefix);
  return values;
}

SmallEigen::SmallEigen(const char *prefix) : prefix_(prefix) {
  constexpr PetscInt divide_and_conquer = 2; // DSHEP; the fastest of its methods with vectors
  RBVI_CALL(EPSCreate(PETSC_COMM_SELF, eps_.put()));
  RBVI_CALL(EPSSetOptionsPrefix(eps_.get(), prefix));
  RBVI_CALL(EPSSetProblemType(eps_.get(), EPS_HEP));
  RBVI_CALL(EPSSetType(eps_.get(), EPSLAPACK));
  RBVI_CALL(EPSSetFromOptions(eps_.get()));
  RBVI_CALL(EPSSetWhichEigenpairs(eps_.get(), EPS_LARGEST_REAL));
  PetscBool dense = PETSC_FALSE;
  RBVI_CALL(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(eps_.get()), EPSLAPACK, &dense));
  if (dense == PETSC_FALSE) return;
  DS ds = nullptr;
  RBVI_CALL(EPSGetDS(eps_.get(), &ds));
  RBVI_CALL(DSSetMethod(ds, divide_and_conquer));
}

Vector SmallEigen::values(const Matrix &matrix) {
  size_ = matrix.rows();
  Vector values(size_);
  if (size_ == 0) return values;
  if (!matrix.allFinite()) throw failure("eigenvalues of a matrix with entries not finite");
  const auto wanted = static_cast<PetscInt>(size_);
  const Handle<Mat> copy = sequential_dense(matrix.selfadjointView<Eigen::Lower>());
  RBVI_CALL(EPSSetOperators(eps_.get(), copy.get(), nullptr));
  RBVI_CALL(EPSSetDimensions(eps_.get(), wanted, PETSC_DEFAULT, PETSC_DEFAULT));
  RBVI_CALL(EPSSolve(eps_.get()));
  PetscInt converged = 0;
  RBVI_CALL(EPSGetConverged(eps_.get(), &converged));
  if (converged < wanted)
    throw failure("SLEPc returned " + std::to_string(converged) + " of " + std::to_string(wanted) +
                  " eigenvalues of a dense matrix: leave out -" + prefix_ + "eps_type");
  for (Index k = 0; k < size_; ++k)
    RBVI_CALL(EPSGetEigenvalue(eps_.get(), static_cast<PetscInt>(k), &values(k), nullptr));
  return values;
}

Matrix SmallEigen::vectors(Index count) const {
  Matrix result(size_, count);
  Handle<Vec> column;
  for (Index k = 0; k < count; ++k) {
    RBVI_CALL(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, static_cast<PetscInt>(size_),
                                    result.col(k).data(), column.put()));
    RBVI_CALL(EPSGetEigenvector(eps_.get(), static_cast<PetscInt>(k), column.get(), nullptr));
  }
  return result;
}

} // namespace rbvi
