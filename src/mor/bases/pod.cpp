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
  /// matrices, then one after the other against those taken from their block.
  std::vector<bool> add_block(BV block, double tolerance) {
    PetscInt count = 0;
    RBVI_CALL(BVGetActiveColumns(block, nullptr, &count));
    const PetscInt known = size_;
    Vector removed = remove(block, count);
    // What is left of less than 0.7 of a column is no longer orthogonal to the rest.
    bool much = false;
    for (PetscInt j = 0; j < count && known > 0; ++j) {
      Vec column = nullptr;
      RBVI_CALL(BVGetColumn(block, j, &column));
      much = much || product_norm(column) < removed[j];
      RBVI_CALL(BVRestoreColumn(block, j, &column));
    }
    if (much) removed = (removed.array().square() + remove(block, count).array().square()).sqrt();
    std::vector<bool> taken;
    for (PetscInt j = 0; j < count; ++j) {
      constexpr double little = 0.1;
      Vec column = nullptr;
      RBVI_CALL(BVGetColumn(block, j, &column));
      const double before = product_norm(column);
      Vector coefficients = remove(column, known);
      // What is left of much is no longer orthogonal to the rest.
      const bool reduced = size_ > known && product_norm(column) < little * before;
      coefficients += remove(column, reduced ? 0 : known).tail(coefficients.size());
      const PetscInt size = size_;
      keep(column, coefficients, removed[j], tolerance);
      RBVI_CALL(BVRestoreColumn(block, j, &column));
      taken.push_back(size_ > size);
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
      if (kept[static_cast<std::size_t>(j)]) taken.push_back(static_cast<int>(first + j));
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

std::vector<int> append_fields(ReplicatedSolver &solver, const Matrix &loads, LinearBasis &basis,
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
