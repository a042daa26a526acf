// A small membrane for the tests: H1 product of P1 on a square grid of n x n free nodes, once
// distributed and once dense, and a trace on the nodes of the lower rows.
#pragma once

#include "../linear_algebra.hpp"
#include "rbvi/fem/trace.hpp"

#include <cmath>
#include <random>
#include <vector>

namespace rbvi::testing_grid {

/// Calls visit(row, column, value) for the entries of `row` of mass + stiffness, cell width
/// 1/(n+1), every cell cut from lower left to upper right.
template <class Visit> void for_each_entry(PetscInt n, PetscInt row, const Visit &visit) {
  const double h = 1.0 / static_cast<double>(n + 1);
  const PetscInt i = row % n, j = row / n;
  const auto at = [&](PetscInt di, PetscInt dj, double stiffness, double mass) {
    const PetscInt a = i + di, b = j + dj;
    if (a >= 0 && b >= 0 && a < n && b < n) visit(row, a + n * b, stiffness + mass * h * h / 12);
  };
  at(-1, -1, 0, 1);
  at(0, -1, -1, 1);
  at(-1, 0, -1, 1);
  at(0, 0, 4, 6);
  at(1, 0, -1, 1);
  at(0, 1, -1, 1);
  at(1, 1, 0, 1);
}

inline Matrix dense_product(PetscInt n) {
  Matrix product = Matrix::Zero(n * n, n * n);
  for (PetscInt row = 0; row < n * n; ++row)
    for_each_entry(n, row, [&](PetscInt r, PetscInt c, double v) { product(r, c) = v; });
  return product;
}

inline Handle<Mat> distributed_product(PetscInt n) {
  Handle<Mat> product;
  PetscInt first = 0, last = 0;
  RBVI_CALL(MatCreateAIJ(PETSC_COMM_WORLD, PETSC_DECIDE, PETSC_DECIDE, n * n, n * n, 7, nullptr, 7,
                         nullptr, product.put()));
  RBVI_CALL(MatGetOwnershipRange(product.get(), &first, &last));
  for (PetscInt row = first; row < last; ++row)
    for_each_entry(n, row, [&](PetscInt r, PetscInt c, double v) {
      RBVI_CALL(MatSetValue(product.get(), r, c, v, INSERT_VALUES));
    });
  RBVI_CALL(MatAssemblyBegin(product.get(), MAT_FINAL_ASSEMBLY));
  RBVI_CALL(MatAssemblyEnd(product.get(), MAT_FINAL_ASSEMBLY));
  return product;
}

/// Contact dof k is grid node nodes[k].
inline Trace make_trace(Mat product, const std::vector<PetscInt> &nodes) {
  Trace trace;
  PetscInt first = 0, last = 0;
  RBVI_CALL(MatGetOwnershipRange(product, &first, &last));
  trace.comm = PETSC_COMM_WORLD;
  trace.size = static_cast<PetscInt>(nodes.size());
  for (std::size_t k = 0; k < nodes.size(); ++k)
    if (nodes[k] >= first && nodes[k] < last) {
      trace.local_row.push_back(nodes[k] - first);
      trace.index.push_back(static_cast<PetscInt>(k));
    }
  return trace;
}

inline Matrix random_matrix(Index rows, Index columns, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  return Matrix::NullaryExpr(rows, columns, [&]() { return uniform(generator); });
}

/// A vector laid out like the rows of `product`, the same for any number of ranks.
inline Handle<Vec> distributed(Mat product, const Vector &values) {
  Handle<Vec> x;
  PetscInt first = 0, last = 0;
  double *local = nullptr;
  RBVI_CALL(MatCreateVecs(product, nullptr, x.put()));
  RBVI_CALL(VecGetOwnershipRange(x.get(), &first, &last));
  RBVI_CALL(VecGetArray(x.get(), &local));
  for (PetscInt row = first; row < last; ++row)
    local[row - first] = values(row);
  RBVI_CALL(VecRestoreArray(x.get(), &local));
  return x;
}

/// All rows of the columns of a dense distributed matrix, on every rank.
inline Matrix gathered(Mat dense) {
  Trace all;
  PetscInt first = 0, last = 0;
  RBVI_CALL(MatGetSize(dense, &all.size, nullptr));
  RBVI_CALL(MatGetOwnershipRange(dense, &first, &last));
  all.comm = PETSC_COMM_WORLD;
  for (PetscInt row = first; row < last; ++row) {
    all.local_row.push_back(row - first);
    all.index.push_back(row);
  }
  return restrict_to(all, dense);
}

inline Matrix gathered(BV columns) {
  Mat dense = nullptr;
  RBVI_CALL(BVGetMat(columns, &dense));
  const Matrix values = gathered(dense);
  RBVI_CALL(BVRestoreMat(columns, &dense));
  return values;
}

/// Smallest beta with sup over the columns of `space` of b(v, X a) / (|v|_V |X a|_W): brute force
/// by generalised eigenproblems in the full space. `b`: dual x free dofs.
inline double brute_infsup(const Matrix &v_product, const Matrix &w_product, const Matrix &b,
                           const Matrix &space, const Matrix &x) {
  const Matrix pairing = x.transpose() * b * space;
  const Matrix riesz = (space.transpose() * v_product * space).ldlt().solve(pairing.transpose());
  const Vector values = generalised_eigenvalues(pairing * riesz, x.transpose() * w_product * x);
  return std::sqrt(std::max(values(0), 0.0));
}

} // namespace rbvi::testing_grid
