// Factors of small dense matrices give back what they were made of, and say where there are none.
#include "rbvi/core/dense.hpp"
#include "rbvi/core/error.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace rbvi::dense_test {
namespace {

Matrix random_matrix(Index rows, Index columns) {
  std::srand(7);
  return Matrix::Random(rows, columns);
}

/// X X^T + 1/10.
Matrix definite(Index size) {
  const Matrix x = random_matrix(size, size);
  return x * x.transpose() + 0.1 * Matrix::Identity(size, size);
}

double distance(const Matrix &a, const Matrix &b) {
  return a.rows() == b.rows() && a.cols() == b.cols() ? (a - b).norm()
                                                      : std::numeric_limits<double>::infinity();
}

TEST(Dense, CholeskyFactorsSolveWithOneColumnAndSeveral) {
  const Matrix a = definite(60), l = cholesky(a, "a");
  EXPECT_LT(distance(l * l.transpose(), a), 1e-12);
  const Vector b = random_matrix(60, 1);
  EXPECT_LT(distance(a * cholesky_solve(l, b), b), 1e-10);
  Matrix x = random_matrix(60, 3);
  const Matrix before = x;
  solve_lower(l, x);
  EXPECT_LT(distance(l * x, before), 1e-12);
  solve_lower_transposed(l, x);
  EXPECT_LT(distance(a * x, before), 1e-10);
  EXPECT_LT(distance(l.transpose() * solve_upper(l.transpose(), before), before), 1e-12);
}

TEST(Dense, CholeskyReadsTheLowerTriangleAndKeepsTheUpper) {
  Matrix a = definite(40);
  const Matrix l = cholesky(a, "a");
  a.triangularView<Eigen::StrictlyUpper>().setConstant(3);
  ASSERT_TRUE(cholesky_in_place(a));
  EXPECT_EQ(a(0, 39), 3);
  EXPECT_LT(distance(Matrix(a.triangularView<Eigen::Lower>()), l), 1e-13);
}

TEST(Dense, WhatIsNotDefiniteOrNoNumberHasNoFactor) {
  Matrix indefinite = -definite(5), none = definite(5);
  none(3, 1) = std::numeric_limits<double>::quiet_NaN();
  for (const Matrix &a : {indefinite, none}) {
    Matrix work = a;
    EXPECT_FALSE(cholesky_in_place(work));
    EXPECT_THROW(cholesky(a, "a"), Error);
    EXPECT_EQ(eigen_pairs(definite(5), a).values.size(), 0);
  }
  EXPECT_THROW(eigen_pairs(none), Error);
  Matrix empty(0, 0);
  EXPECT_TRUE(cholesky_in_place(empty));
}

TEST(Dense, ThinQrOfTallAndOfWideMatrices) {
  for (const auto &[rows, columns] : {std::pair<Index, Index>{9, 4}, {4, 9}, {5, 5}, {3, 0}}) {
    const Matrix a = random_matrix(rows, columns);
    const auto [q, r] = thin_qr(a);
    const Index size = std::min(rows, columns);
    EXPECT_LT(distance(q.transpose() * q, Matrix::Identity(size, size)), 1e-14);
    EXPECT_LT(distance(q * r, a), 1e-14);
    EXPECT_LT(distance(triangular_factor(a), r), 1e-14);
  }
}

TEST(Dense, EigenPairsOfOneMatrixAndOfTwo) {
  const Matrix a = random_matrix(7, 7) + random_matrix(7, 7).transpose(), b = definite(7);
  const EigenPairs one = eigen_pairs(a), two = eigen_pairs(a, b);
  EXPECT_LT(distance(a * one.vectors, one.vectors * one.values.asDiagonal()), 1e-12);
  EXPECT_LT(distance(a * two.vectors, b * two.vectors * two.values.asDiagonal()), 1e-10);
  EXPECT_LT(distance(two.vectors.transpose() * b * two.vectors, Matrix::Identity(7, 7)), 1e-12);
  EXPECT_LE(two.values[0], two.values[6]);
}

TEST(Dense, LuSolves) {
  const Matrix a = random_matrix(6, 6), b = random_matrix(6, 2);
  EXPECT_LT(distance(a * lu_solve(a, b), b), 1e-12);
}

} // namespace
} // namespace rbvi::dense_test
