// Niakh (2022): (B.9)-(B.12).
#include "rbvi/mor/pod.hpp"

#include "append_block.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/par/columns.hpp"
#include "rbvi/par/small_svd.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace rbvi {

namespace {

constexpr double least_remainder = 1e-13; // remainder of a snapshot, relative to its norm
constexpr double equal = 1e-8;            // singular values this close are kept or cut together
constexpr double sign_tie = 1e-10;

/// What append_block wants of a basis over the ranks. BVOrthogonalize does the same of columns that
/// are all far from dependent; of others it says neither which nor how much is left of them.
class BvColumns {
public:
  BvColumns(const LinearBasis &basis, PetscInt more)
      : basis_(basis.columns.get()), size_(basis.size()) {
    RBVI_CALL(BVResize(basis_, size_ + more, PETSC_TRUE));
  }
  Matrix gram(BV block, Index n) const {
    use(block, n);
    return products(block, block, n, n);
  }
  Vector remove(BV block, Index n) const {
    if (size_ == 0) return Vector::Zero(n);
    use(block, n);
    use(basis_, size_);
    Matrix inside = products(basis_, block, size_, n);
    RBVI_CALL(BVMult(block, -1.0, 1.0, basis_, sequential_dense(inside).get()));
    return inside.colwise().norm();
  }
  static void rotate(BV block, const Matrix &rotation) {
    use(block, rotation.rows());
    RBVI_CALL(BVMultInPlace(block, sequential_dense(rotation).get(), 0,
                            static_cast<PetscInt>(rotation.cols())));
  }
  void take(BV block, Index n) {
    for (PetscInt j = 0; j < n; ++j) {
      Vec column = nullptr;
      RBVI_CALL(BVGetColumn(block, j, &column));
      RBVI_CALL(BVInsertVec(basis_, size_++, column));
      RBVI_CALL(BVRestoreColumn(block, j, &column));
    }
  }
  /// Cuts the storage of the basis down to its columns, all of them active.
  void finish() const {
    RBVI_CALL(BVResize(basis_, size_, PETSC_TRUE));
    use(basis_, size_);
  }

private:
  static void use(BV columns, Index n) {
    RBVI_CALL(BVSetActiveColumns(columns, 0, static_cast<PetscInt>(n)));
  }
  /// X^T P Y.
  static Matrix products(BV x, BV y, Index rows, Index columns) {
    Matrix result(rows, columns);
    Handle<Mat> view;
    RBVI_CALL(MatCreateSeqDense(PETSC_COMM_SELF, static_cast<PetscInt>(rows),
                                static_cast<PetscInt>(columns), result.data(), view.put()));
    RBVI_CALL(BVDot(y, x, view.get()));
    if (!result.allFinite()) throw failure("columns to orthonormalise are not finite");
    return result;
  }

  BV basis_;
  PetscInt size_;
};

void fix_signs(SmallSvd &svd) {
  for (Index k = 0; k < svd.values.size(); ++k) {
    const double largest = svd.right.col(k).cwiseAbs().maxCoeff();
    Index first = 0;
    while (std::abs(svd.right(first, k)) < (1 - sign_tie) * largest)
      ++first;
    if (svd.right(first, k) < 0) svd.left.col(k) = -svd.left.col(k);
  }
}

Index truncation(const Vector &values, const std::vector<double> &errors,
                 const PodOptions &options) {
  const auto splits = [&](Index n) {
    return n > 0 && n < values.size() && values(n) >= (1 - equal) * values(n - 1);
  };
  Index n = 1;
  while (n < values.size() && errors[n] > options.tolerance)
    ++n;
  while (splits(n))
    ++n;
  if (options.max_size == 0 || n <= options.max_size) return n;
  n = options.max_size;
  while (splits(n))
    --n;
  if (n == 0)
    throw bad_input("the first singular values of the snapshots are equal and more than the basis "
                    "may have (" +
                    std::to_string(options.max_size) + "); raise its maximal size");
  return n;
}

} // namespace

std::vector<double> projection_errors(const Vector &values) {
  std::vector<double> errors(static_cast<std::size_t>(values.size()) + 1, 0.0);
  const Vector scaled = values / values(0);
  double tail = 0;
  for (Index n = values.size() - 1; n >= 0; --n) {
    tail += scaled(n) * scaled(n);
    errors[n] = std::sqrt(tail);
  }
  const double total = errors[0];
  for (double &error : errors)
    error /= total;
  return errors;
}

PetscInt LinearBasis::size() const {
  PetscInt count = 0;
  RBVI_CALL(BVGetSizes(columns.get(), nullptr, nullptr, &count));
  return count;
}

Pod pod(const std::vector<Vec> &snapshots, Mat product, const PodOptions &options) {
  if (!(options.tolerance >= 0 && options.tolerance < 1))
    throw bad_input("the tolerance of a POD must be in [0, 1)");
  if (options.max_size < 0) throw bad_input("the maximal size of a POD must not be negative");
  if (snapshots.empty()) throw failure("a POD needs at least one snapshot");

  const auto count = static_cast<PetscInt>(snapshots.size());
  Pod result;
  result.basis.columns = make_columns(snapshots.front(), count, product);
  const BV columns = result.basis.columns.get();

  Matrix factor = Matrix::Zero(count, count);
  PetscInt rank = 0;
  for (PetscInt p = 0; p < count; ++p) {
    double norm = 0, remainder = 0;
    RBVI_CALL(VecNorm(snapshots[p], NORM_2, &norm));
    if (!std::isfinite(norm)) throw failure("a snapshot has entries that are not finite");
    RBVI_CALL(BVInsertVec(columns, rank, snapshots[p]));
    RBVI_CALL(BVOrthogonalizeColumn(columns, rank, factor.col(p).data(), &remainder, nullptr));
    factor(rank, p) = 0;
    if (remainder <= least_remainder * std::hypot(factor.col(p).norm(), remainder)) continue;
    RBVI_CALL(BVScaleColumn(columns, rank, 1 / remainder));
    factor(rank++, p) = remainder;
  }
  if (rank == 0)
    throw failure("the displacements at all training parameters are zero: nothing moves the body; "
                  "is there a load, a motion or an imposed displacement, and -train with other "
                  "parameters than those without any?");

  SmallSvd svd = small_svd(factor.topRows(rank));
  fix_signs(svd);
  result.singular_values.assign(svd.values.begin(), svd.values.end());
  result.error = projection_errors(svd.values);
  const auto kept = static_cast<PetscInt>(truncation(svd.values, result.error, options));
  RBVI_CALL(BVSetActiveColumns(columns, 0, rank));
  rotate(result.basis, svd.left.leftCols(kept));
  return result;
}

void rotate(LinearBasis &basis, const Matrix &rotation) {
  const BV columns = basis.columns.get();
  const auto kept = static_cast<PetscInt>(rotation.cols());
  RBVI_CALL(BVMultInPlace(columns, sequential_dense(rotation).get(), 0, kept));
  RBVI_CALL(BVResize(columns, kept, PETSC_TRUE));
  RBVI_CALL(BVSetActiveColumns(columns, 0, kept));
}

namespace {

/// append_block() of columns, some at a time. Collective.
std::vector<int> append(BvColumns &basis, Mat product, Mat columns, double tolerance) {
  constexpr PetscInt width = 48; ///< columns at a time
  PetscInt count = 0;
  Handle<Vec> work;
  RBVI_CALL(MatGetSize(columns, nullptr, &count));
  RBVI_CALL(MatCreateVecs(columns, nullptr, work.put()));
  const Handle<BV> block = make_columns(work.get(), std::max(1, std::min(width, count)), product);
  std::vector<int> taken;
  for (PetscInt first = 0; first < count; first += width) {
    const PetscInt many = std::min(width, count - first);
    RBVI_CALL(BVSetActiveColumns(block.get(), 0, many));
    for (PetscInt j = 0; j < many; ++j) {
      RBVI_CALL(MatGetColumnVector(columns, work.get(), first + j));
      RBVI_CALL(BVInsertVec(block.get(), j, work.get()));
    }
    BV filled = block.get();
    for (const int j : append_block(basis, filled, many, tolerance))
      taken.push_back(static_cast<int>(first) + j);
  }
  return taken;
}

Mat product_of(const LinearBasis &basis) {
  Mat product = nullptr;
  RBVI_CALL(BVGetMatrix(basis.columns.get(), &product, nullptr));
  return product;
}

} // namespace

std::vector<int> append_orthonormalised(LinearBasis &basis, Mat columns, double tolerance) {
  PetscInt count = 0;
  RBVI_CALL(MatGetSize(columns, nullptr, &count));
  BvColumns growing(basis, count);
  const std::vector<int> taken = append(growing, product_of(basis), columns, tolerance);
  growing.finish();
  return taken;
}

std::vector<int> append_fields(ResponseSolver &solver, const Matrix &loads, LinearBasis &basis,
                               double tolerance, Matrix *traces) {
  constexpr Index at_a_time = 192;
  std::vector<int> taken;
  if (traces != nullptr) traces->resize(loads.rows(), loads.cols());
  BvColumns growing(basis, static_cast<PetscInt>(loads.cols()));
  for (Index first = 0; first < loads.cols(); first += at_a_time) {
    const Index count = std::min(at_a_time, loads.cols() - first);
    const Handle<Mat> fields = solver.fields(loads.middleCols(first, count));
    if (traces != nullptr) traces->middleCols(first, count) = solver.restrict(fields.get());
    for (const int k : append(growing, product_of(basis), fields.get(), tolerance))
      taken.push_back(static_cast<int>(first) + k);
  }
  growing.finish();
  return taken;
}

} // namespace rbvi
