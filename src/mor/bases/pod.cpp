#include "rbvi/mor/bases/pod.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/par/small_svd.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <string>

namespace rbvi {

namespace {

constexpr double dependent = 1e-13; // remainder of a snapshot, relative to its norm
constexpr double equal = 1e-8;      // singular values this close are kept or cut together
constexpr double sign_tie = 1e-10;
constexpr double much_removed = 0.1; // what is left of a column is no longer orthogonal to the rest

/// Classical Gram-Schmidt in the product of `basis`; twice, but for blocks that lose little.
class GramSchmidt {
public:
  GramSchmidt(BV basis, PetscInt size, PetscInt capacity) : basis_(basis), size_(size) {
    RBVI_CALL(BVGetMatrix(basis_, &product_, nullptr));
    RBVI_CALL(BVResize(basis_, capacity, PETSC_TRUE));
    RBVI_CALL(MatCreateVecs(product_, nullptr, image_.put()));
  }

  PetscInt size() const { return size_; }

  /// Coefficients of `column` in the basis, the new column's last if it is taken; `column` becomes
  /// its remainder.
  Vector add(Vec column, double tolerance) {
    Vector coefficients = remove(column, 0);
    coefficients += remove(column, 0);
    return keep(column, coefficients, 0, tolerance);
  }

  /// Whether each column of a block was taken. All of them against the basis first, by products of
  /// matrices; then those that have enough of their own together, and the others one by one.
  std::vector<bool> add_block(BV block, double tolerance) {
    PetscInt count = 0;
    RBVI_CALL(BVGetActiveColumns(block, nullptr, &count));
    const PetscInt known = size_;
    Vector removed = remove(block, count);
    Matrix gram = gram_of(block, count);
    // What is left of less than 0.7 of a column is no longer orthogonal to the rest.
    if (known > 0 && (gram.diagonal().array() < removed.array().square()).any()) {
      removed = (removed.array().square() + remove(block, count).array().square()).sqrt();
      gram = gram_of(block, count);
    }
    std::vector<bool> taken = orthonormalise(block, gram, removed, tolerance);
    for (PetscInt j = 0; j < count; ++j)
      if (taken[j]) insert(block, j);
    for (PetscInt j = 0; j < count; ++j) {
      if (taken[j]) continue;
      Vec column = nullptr;
      RBVI_CALL(BVGetColumn(block, j, &column));
      const double before = product_norm(column);
      Vector coefficients = remove(column, known);
      const bool reduced = size_ > known && product_norm(column) < much_removed * before;
      coefficients += remove(column, reduced ? 0 : known).tail(coefficients.size());
      const PetscInt size = size_;
      keep(column, coefficients, removed[j], tolerance);
      RBVI_CALL(BVRestoreColumn(block, j, &column));
      taken[j] = size_ > size;
    }
    return taken;
  }

  /// Cuts the storage of the basis down to its columns, all of them active.
  void finish() {
    PetscInt capacity = 0;
    RBVI_CALL(BVGetSizes(basis_, nullptr, nullptr, &capacity));
    if (size_ < capacity) RBVI_CALL(BVResize(basis_, size_, PETSC_TRUE));
    RBVI_CALL(BVSetActiveColumns(basis_, 0, size_));
  }

private:
  /// Makes a column orthogonal to those from `first` on; its coefficients in them.
  Vector remove(Vec column, PetscInt first) {
    Vector step(size_ - first);
    if (step.size() == 0) return step;
    RBVI_CALL(BVSetActiveColumns(basis_, first, size_));
    RBVI_CALL(BVDotVec(basis_, column, step.data()));
    RBVI_CALL(BVMultVec(basis_, -1.0, 1.0, column, step.data()));
    return step;
  }
  /// Makes columns orthogonal to the basis; the norm of what each loses.
  Vector remove(BV block, PetscInt count) {
    if (size_ == 0) return Vector::Zero(count);
    RBVI_CALL(BVSetActiveColumns(basis_, 0, size_));
    Matrix coefficients(size_, count);
    Handle<Mat> view;
    RBVI_CALL(MatCreateSeqDense(PETSC_COMM_SELF, size_, count, coefficients.data(), view.put()));
    RBVI_CALL(BVDot(block, basis_, view.get()));
    RBVI_CALL(BVMult(block, -1.0, 1.0, basis_, view.get()));
    return coefficients.colwise().norm();
  }
  /// X^T X of a block X in the product.
  static Matrix gram_of(BV block, PetscInt count) {
    Matrix gram(count, count);
    Handle<Mat> view;
    RBVI_CALL(MatCreateSeqDense(PETSC_COMM_SELF, count, count, gram.data(), view.put()));
    RBVI_CALL(BVDot(block, block, view.get()));
    if (!gram.allFinite())
      throw failure("a column to orthonormalise has entries that are not finite");
    return gram;
  }
  /// Those columns of a block that have enough of their own, and how much they have of it.
  struct Fit {
    std::vector<Index> columns;
    Matrix factor;    ///< lower triangle, of their Gram matrix scaled to a diagonal of 1
    double least = 1; ///< its smallest pivot
  };
  /// `gram`: of the block; `removed`: the norm of what is no longer in each column.
  static Fit fit_columns(const Matrix &gram, const Vector &norms, const Vector &removed,
                         double tolerance) {
    constexpr double own = 1e-4; // one Cholesky factor leaves angles of round-off over its square
    Fit fit;
    Matrix factor = Matrix::Zero(gram.rows(), gram.cols());
    for (Index j = 0; j < gram.cols(); ++j) {
      if (!(norms[j] > 0)) continue;
      const auto size = std::ssize(fit.columns);
      Vector row = gram(fit.columns, j).cwiseQuotient(norms(fit.columns)) / norms[j];
      factor.topLeftCorner(size, size).triangularView<Eigen::Lower>().solveInPlace(row);
      const double left = std::sqrt(std::max(0.0, 1 - row.squaredNorm()));
      if (!(left > own) || left * norms[j] <= tolerance * std::hypot(removed[j], norms[j]))
        continue;
      factor.row(size).head(size) = row.transpose();
      factor(size, size) = left;
      fit.least = std::min(fit.least, left);
      fit.columns.push_back(j);
    }
    const auto size = std::ssize(fit.columns);
    fit.factor = factor.topLeftCorner(size, size);
    return fit;
  }
  /// The columns of a block that have enough of their own, made orthonormal to each other by a
  /// Cholesky factor of their Gram matrix, twice. Which they are; the others are as they were.
  std::vector<bool> orthonormalise(BV block, const Matrix &gram, const Vector &removed,
                                   double tolerance) {
    const auto count = static_cast<PetscInt>(gram.cols());
    const Vector norms = gram.diagonal().cwiseMax(0).cwiseSqrt();
    const Fit fit = fit_columns(gram, norms, removed, tolerance);
    std::vector<bool> taken(count, false);
    if (fit.columns.empty()) return taken;
    rotate(block, count, fit.columns, norms(fit.columns).cwiseInverse(), fit.factor);
    if (fit.least < much_removed) remove(block, count);
    const Matrix again = gram_of(block, count)(fit.columns, fit.columns);
    rotate(block, count, fit.columns, Vector::Ones(again.cols()),
           cholesky(again, "the Gram matrix of fields that are nearly orthonormal"));
    for (const Index j : fit.columns)
      taken[j] = true;
    return taken;
  }
  /// X <- X D L^-T for these columns of a block.
  static void rotate(BV block, PetscInt count, const std::vector<Index> &columns,
                     const Vector &scale, const Matrix &lower) {
    Matrix inverse = scale.asDiagonal();
    lower.transpose().triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(inverse);
    Matrix rotation = Matrix::Identity(count, count);
    rotation(columns, columns) = inverse;
    RBVI_CALL(BVMultInPlace(block, sequential_dense(rotation).get(), 0, count));
  }
  void insert(BV block, PetscInt j) {
    Vec column = nullptr;
    RBVI_CALL(BVGetColumn(block, j, &column));
    RBVI_CALL(BVInsertVec(basis_, size_++, column));
    RBVI_CALL(BVRestoreColumn(block, j, &column));
  }
  double product_norm(Vec column) {
    double square = 0;
    RBVI_CALL(MatMult(product_, column, image_.get()));
    RBVI_CALL(VecDot(column, image_.get(), &square));
    if (!std::isfinite(square))
      throw failure("a column to orthonormalise has entries that are not finite");
    return std::sqrt(std::max(square, 0.0));
  }
  /// Takes the remainder of a column unless it is small beside the column; `removed`: the norm of
  /// what was removed beside the coefficients.
  Vector keep(Vec column, Vector coefficients, double removed, double tolerance) {
    const double remainder = product_norm(column);
    const double norm = std::hypot(removed, coefficients.norm(), remainder);
    if (remainder <= tolerance * norm) return coefficients;
    coefficients.conservativeResize(coefficients.size() + 1);
    coefficients.tail(1)[0] = remainder;
    RBVI_CALL(VecScale(column, 1 / remainder));
    RBVI_CALL(BVInsertVec(basis_, size_, column));
    ++size_;
    return coefficients;
  }

  BV basis_;
  PetscInt size_;
  Mat product_ = nullptr;
  Handle<Vec> image_;
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
  RBVI_CALL(BVCreate(PetscObjectComm(reinterpret_cast<PetscObject>(product)),
                     result.basis.columns.put()));
  const BV columns = result.basis.columns.get();
  RBVI_CALL(BVSetSizesFromVec(columns, snapshots.front(), count));
  RBVI_CALL(BVSetType(columns, BVMAT));
  RBVI_CALL(BVSetMatrix(columns, product, PETSC_FALSE));

  GramSchmidt factorisation(columns, 0, count);
  Handle<Vec> work;
  RBVI_CALL(VecDuplicate(snapshots.front(), work.put()));
  Matrix factor = Matrix::Zero(count, count);
  for (PetscInt p = 0; p < count; ++p) {
    RBVI_CALL(VecCopy(snapshots[p], work.get()));
    const Vector coefficients = factorisation.add(work.get(), dependent);
    factor.col(p).head(coefficients.size()) = coefficients;
  }
  const PetscInt rank = factorisation.size();
  if (rank == 0)
    throw failure("the displacements at all training parameters are zero: nothing moves the body; "
                  "is there a load, a motion or an imposed displacement, and -train with other "
                  "parameters than those without any?");

  SmallSvd svd = small_svd(factor.topRows(rank));
  fix_signs(svd);
  result.singular_values.assign(svd.values.begin(), svd.values.end());
  result.error = projection_errors(svd.values);
  const auto kept = static_cast<PetscInt>(truncation(svd.values, result.error, options));
  const Handle<Mat> rotation = sequential_dense(svd.left);
  RBVI_CALL(BVSetActiveColumns(columns, 0, rank));
  RBVI_CALL(BVMultInPlace(columns, rotation.get(), 0, kept));
  RBVI_CALL(BVResize(columns, kept, PETSC_TRUE));
  RBVI_CALL(BVSetActiveColumns(columns, 0, kept));
  return result;
}

namespace {

/// Makes columns orthonormal to a basis and to each other, and appends them; which were taken.
/// Collective.
std::vector<int> append(GramSchmidt &factorisation, Mat product, Mat columns, double tolerance) {
  constexpr PetscInt width = 48; ///< columns at a time
  PetscInt count = 0;
  Handle<Vec> work;
  Handle<BV> block;
  RBVI_CALL(MatGetSize(columns, nullptr, &count));
  RBVI_CALL(MatCreateVecs(columns, nullptr, work.put()));
  RBVI_CALL(BVCreate(PetscObjectComm(reinterpret_cast<PetscObject>(columns)), block.put()));
  RBVI_CALL(BVSetSizesFromVec(block.get(), work.get(), std::max(1, std::min(width, count))));
  RBVI_CALL(BVSetType(block.get(), BVMAT));
  RBVI_CALL(BVSetMatrix(block.get(), product, PETSC_FALSE));
  std::vector<int> taken;
  for (PetscInt first = 0; first < count; first += width) {
    const PetscInt many = std::min(width, count - first);
    RBVI_CALL(BVSetActiveColumns(block.get(), 0, many));
    for (PetscInt j = 0; j < many; ++j) {
      RBVI_CALL(MatGetColumnVector(columns, work.get(), first + j));
      RBVI_CALL(BVInsertVec(block.get(), j, work.get()));
    }
    const std::vector<bool> kept = factorisation.add_block(block.get(), tolerance);
    for (PetscInt j = 0; j < many; ++j)
      if (kept[j]) taken.push_back(static_cast<int>(first + j));
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
  GramSchmidt factorisation(basis.columns.get(), basis.size(), basis.size() + count);
  const std::vector<int> taken = append(factorisation, product_of(basis), columns, tolerance);
  factorisation.finish();
  return taken;
}

std::vector<int> append_fields(ResponseSolver &solver, const Matrix &loads, LinearBasis &basis,
                               double tolerance, Matrix *traces) {
  constexpr Index at_a_time = 192;
  std::vector<int> taken;
  if (traces != nullptr) traces->resize(loads.rows(), loads.cols());
  GramSchmidt factorisation(basis.columns.get(), basis.size(),
                            basis.size() + static_cast<PetscInt>(loads.cols()));
  for (Index first = 0; first < loads.cols(); first += at_a_time) {
    const Index count = std::min(at_a_time, loads.cols() - first);
    const Handle<Mat> fields = solver.fields(loads.middleCols(first, count));
    if (traces != nullptr) traces->middleCols(first, count) = solver.restrict(fields.get());
    for (const int k : append(factorisation, product_of(basis), fields.get(), tolerance))
      taken.push_back(static_cast<int>(first) + k);
  }
  factorisation.finish();
  return taken;
}

} // namespace rbvi
