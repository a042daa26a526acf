#include "rbvi/mor/bases/pod.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/par/small_svd.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace rbvi {

namespace {

constexpr double dependent = 1e-13; // remainder of a snapshot, relative to its norm
constexpr double equal = 1e-8;      // singular values this close are kept or cut together
constexpr double sign_tie = 1e-10;

/// Classical Gram-Schmidt, twice, in the product of `basis`. The image product * basis is kept, so
/// that a new column costs one product and three reductions.
class GramSchmidt {
public:
  GramSchmidt(BV basis, PetscInt size, PetscInt capacity) : basis_(basis), size_(size) {
    RBVI_CALL(BVGetMatrix(basis_, &product_, nullptr));
    RBVI_CALL(BVResize(basis_, capacity, PETSC_TRUE));
    RBVI_CALL(BVCreate(PetscObjectComm(reinterpret_cast<PetscObject>(basis_)), image_.put()));
    RBVI_CALL(MatCreateVecs(product_, nullptr, product_column_.put()));
    RBVI_CALL(BVSetSizesFromVec(image_.get(), product_column_.get(), capacity));
    RBVI_CALL(BVSetType(image_.get(), BVMAT));
    activate();
    if (size_ > 0) RBVI_CALL(BVMatMult(basis_, product_, image_.get()));
  }

  PetscInt size() const { return size_; }

  /// Coefficients of `column` in the basis, the new column's last if it is taken; `column` becomes
  /// its remainder.
  Vector add(Vec column, double tolerance) {
    Vector coefficients = Vector::Zero(size_ + 1);
    activate();
    for (int pass = 0; pass < 2 && size_ > 0; ++pass) {
      Vector step(size_);
      RBVI_CALL(BVDotVec(image_.get(), column, step.data()));
      RBVI_CALL(BVMultVec(basis_, -1.0, 1.0, column, step.data()));
      coefficients.head(size_) += step;
    }
    double square = 0;
    RBVI_CALL(MatMult(product_, column, product_column_.get()));
    RBVI_CALL(VecDot(column, product_column_.get(), &square));
    const double remainder = std::sqrt(std::max(square, 0.0));
    const double norm = std::hypot(coefficients.norm(), remainder);
    if (!std::isfinite(square) || !std::isfinite(norm))
      throw failure("a column to orthonormalise has entries that are not finite");
    if (remainder <= tolerance * norm) return coefficients.head(size_);
    coefficients(size_) = remainder;
    RBVI_CALL(VecScale(column, 1 / remainder));
    RBVI_CALL(VecScale(product_column_.get(), 1 / remainder));
    RBVI_CALL(BVInsertVec(basis_, size_, column));
    RBVI_CALL(BVInsertVec(image_.get(), size_, product_column_.get()));
    ++size_;
    return coefficients;
  }

  /// Cuts the storage of the basis down to its columns.
  void finish() { RBVI_CALL(BVResize(basis_, size_, PETSC_TRUE)); }

private:
  void activate() {
    RBVI_CALL(BVSetActiveColumns(basis_, 0, size_));
    RBVI_CALL(BVSetActiveColumns(image_.get(), 0, size_));
  }

  BV basis_;
  PetscInt size_;
  Mat product_ = nullptr;
  Handle<BV> image_;
  Handle<Vec> product_column_;
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
    errors[static_cast<std::size_t>(n)] = std::sqrt(tail);
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
  while (n < values.size() && errors[static_cast<std::size_t>(n)] > options.tolerance)
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
    RBVI_CALL(VecCopy(snapshots[static_cast<std::size_t>(p)], work.get()));
    const Vector coefficients = factorisation.add(work.get(), dependent);
    factor.col(p).head(coefficients.size()) = coefficients;
  }
  const PetscInt rank = factorisation.size();
  if (rank == 0) throw failure("all snapshots of a POD are zero");

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

std::vector<int> append_orthonormalised(LinearBasis &basis, Mat columns, double tolerance) {
  PetscInt count = 0;
  RBVI_CALL(MatGetSize(columns, nullptr, &count));
  GramSchmidt factorisation(basis.columns.get(), basis.size(), basis.size() + count);
  Handle<Vec> work;
  RBVI_CALL(MatCreateVecs(columns, nullptr, work.put()));
  std::vector<int> taken;
  for (PetscInt j = 0; j < count; ++j) {
    RBVI_CALL(MatGetColumnVector(columns, work.get(), j));
    const PetscInt before = factorisation.size();
    factorisation.add(work.get(), tolerance);
    if (factorisation.size() > before) taken.push_back(static_cast<int>(j));
  }
  factorisation.finish();
  RBVI_CALL(BVSetActiveColumns(basis.columns.get(), 0, basis.size()));
  return taken;
}

} // namespace rbvi
