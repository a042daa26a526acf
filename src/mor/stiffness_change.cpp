#include "rbvi/mor/stiffness_change.hpp"

#include "eim_terms.hpp"
#include "rbvi/model/packed.hpp"
#include "rbvi/mor/operator_entries.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/columns.hpp"
#include "rbvi/par/small_svd.hpp"

#include <slepcbv.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace rbvi {

namespace {

constexpr Index few = 256;          ///< primal functions: below, all terms are small
constexpr double vanishing = 1e-12; ///< of the largest entry of A
constexpr double resolved = 1e-13;  ///< singular values of the restricted basis, of the largest
constexpr double accurate = 1e-11;  ///< what is left of its columns, of the largest one

/// A(mu) - A_1. Collective.
Handle<Mat> difference(Problem &problem, const Mu &mu, Mat first) {
  problem.assemble(mu);
  Handle<Mat> result;
  RBVI_CALL(MatDuplicate(problem.a_terms().mapped.get(), MAT_COPY_VALUES, result.put()));
  RBVI_CALL(MatAXPY(result.get(), -1, first, SAME_NONZERO_PATTERN));
  return result;
}

/// Whether A(mu) - A_1 has more than round-off in each row of this rank, for some mu. Collective.
std::vector<bool> changing_rows(Problem &problem, const std::vector<Mu> &set, Mat first) {
  Handle<Vec> row, largest;
  RBVI_CALL(MatCreateVecs(first, nullptr, row.put()));
  RBVI_CALL(VecDuplicate(row.get(), largest.put()));
  PetscReal scale = 0;
  RBVI_CALL(MatGetRowMaxAbs(first, row.get(), nullptr));
  RBVI_CALL(VecMax(row.get(), nullptr, &scale));
  RBVI_CALL(VecSet(largest.get(), 0));
  for (std::size_t p = 1; p < set.size(); ++p) {
    RBVI_CALL(MatGetRowMaxAbs(difference(problem, set[p], first).get(), row.get(), nullptr));
    RBVI_CALL(VecPointwiseMax(largest.get(), largest.get(), row.get()));
  }
  const Vector values = local_values(largest.get());
  std::vector<bool> result;
  for (const double value : values)
    result.push_back(value > vanishing * scale);
  return result;
}

/// The rows of a basis that change, the others zero.
Matrix masked(Matrix rows, const std::vector<bool> &changing) {
  for (Index i = 0; i < rows.rows(); ++i)
    if (!changing[i]) rows.row(i).setZero();
  return rows;
}

void set_rows(BV columns, const Matrix &rows) {
  PetscScalar *values = nullptr;
  RBVI_CALL(BVGetArray(columns, &values));
  Eigen::Map<Matrix>(values, rows.rows(), rows.cols()) = rows;
  RBVI_CALL(BVRestoreArray(columns, &values));
}

/// Orthonormal columns that span those of `count` random combinations of the basis, restricted.
/// Collective.
Handle<BV> sampled_range(Mat basis, const std::vector<bool> &changing, Index count) {
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  const BorrowedRows rows(basis);
  const Matrix mixed =
      Matrix::NullaryExpr(rows.rows().cols(), count, [&] { return normal(generator); });
  Handle<Vec> column;
  RBVI_CALL(MatCreateVecs(basis, nullptr, column.put()));
  Handle<BV> range = make_columns(column.get(), count, nullptr);
  RBVI_CALL(BVSetOrthogonalization(range.get(), BV_ORTHOG_CGS, BV_ORTHOG_REFINE_ALWAYS,
                                   PETSC_DEFAULT, BV_ORTHOG_BLOCK_TSQR));
  set_rows(range.get(), masked(rows.rows() * mixed, changing));
  const Handle<Mat> triangle = sequential_dense(Matrix::Zero(count, count));
  RBVI_CALL(BVOrthogonalize(range.get(), triangle.get()));
  const SmallSvd svd = small_svd(BorrowedRows(triangle.get()).rows());
  const Index rank = (svd.values.array() > resolved * svd.values[0]).count();
  const Handle<Mat> rotation = sequential_dense(svd.left);
  RBVI_CALL(BVMultInPlace(range.get(), rotation.get(), 0, static_cast<PetscInt>(rank)));
  RBVI_CALL(BVResize(range.get(), static_cast<PetscInt>(rank), PETSC_TRUE));
  RBVI_CALL(BVSetActiveColumns(range.get(), 0, static_cast<PetscInt>(rank)));
  // The last columns have round-off of their own beyond the rows that change.
  set_rows(range.get(), masked(BorrowedRows(BorrowedColumns(range.get()).get()).rows(), changing));
  return range;
}

/// Whether U coordinates^T is the restricted basis, to `accurate`. Collective.
bool holds_all(Mat basis, const std::vector<bool> &changing, Mat range, const Matrix &coordinates) {
  constexpr Index width = 64;
  const BorrowedRows all(basis), few_rows(range);
  const Index n = all.rows().cols();
  Vector squares = Vector::Zero(2 * n); // of the columns, then of what is left of them
  for (Index first = 0; first < n; first += width) {
    const Index count = std::min(width, n - first);
    Matrix block = masked(all.rows().middleCols(first, count), changing);
    squares.segment(first, count) = block.colwise().squaredNorm();
    block.noalias() -= few_rows.rows() * coordinates.middleRows(first, count).transpose();
    squares.segment(n + first, count) = block.colwise().squaredNorm();
  }
  over_ranks(comm_of(basis), MPI_SUM, squares);
  return squares.tail(n).maxCoeff() <= accurate * accurate * squares.head(n).maxCoeff();
}

/// V^T U. Collective.
Matrix coordinates_in(Mat basis, Mat range) {
  Matrix result = BorrowedRows(basis).rows().transpose() * BorrowedRows(range).rows();
  over_ranks(comm_of(basis), MPI_SUM, result);
  return result;
}

/// Scales and cores of the terms. Collective.
void add_cores(Problem &problem, const Eim &eim, const std::vector<Mu> &set, Mat first, Mat range,
               StiffnessChange &change) {
  const Index r = change.rank();
  Matrix terms = Matrix::Zero(1 + r * (r + 1) / 2, eim.size()); // scale and core of each
  for (std::size_t p = 0; p < set.size(); ++p) {
    Vector of_snapshot = Vector::Zero(terms.rows());
    of_snapshot[0] = 1;
    if (p > 0)
      of_snapshot.tail(terms.rows() - 1) =
          pack(projected(range, difference(problem, set[p], first).get(), range));
    accumulate(eim, eim.snapshots[p], of_snapshot, terms);
  }
  change.scales = terms.row(0).transpose();
  change.cores = terms.bottomRows(terms.rows() - 1);
}

} // namespace

StiffnessChange stiffness_change(Problem &problem, const Eim &eim, const std::vector<Mu> &set,
                                 Mat basis) {
  PetscInt n = 0;
  RBVI_CALL(MatGetSize(basis, nullptr, &n));
  if (n < few || eim.size() < 2 || !problem.a_terms().exact.empty()) return {};
  problem.assemble(set.front());
  Handle<Mat> first;
  RBVI_CALL(MatDuplicate(problem.a_terms().mapped.get(), MAT_COPY_VALUES, first.put()));
  const std::vector<bool> changing = changing_rows(problem, set, first.get());
  for (Index sampled = 128; sampled <= n / 2; sampled *= 2) {
    const Handle<BV> range = sampled_range(basis, changing, sampled);
    const BorrowedColumns columns(range.get());
    StiffnessChange change;
    change.range = coordinates_in(basis, columns.get());
    if (3 * change.rank() > n || !holds_all(basis, changing, columns.get(), change.range)) continue;
    add_cores(problem, eim, set, first.get(), columns.get(), change);
    return change;
  }
  return {};
}

} // namespace rbvi
