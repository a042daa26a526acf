#include "../linear_algebra.hpp"
#include "rbvi/par/small_svd.hpp"

#include "../mor/grid.hpp"
#include "rbvi/core/error.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace rbvi::small_svd_test {
namespace {

void expect_svd(const Matrix &matrix) {
  const Matrix copy = matrix;
  const SmallSvd svd = small_svd(matrix);
  const Index count = std::min(matrix.rows(), matrix.cols());
  ASSERT_EQ(svd.values.size(), count);
  const double scale = matrix.norm();
  EXPECT_EQ(matrix, copy);
  EXPECT_LE((svd.left * svd.values.asDiagonal() * svd.right.transpose() - matrix).norm(),
            1e-13 * scale);
  const Matrix identity = Matrix::Identity(count, count);
  EXPECT_LE((svd.left.transpose() * svd.left - identity).norm(), 1e-12);
  EXPECT_LE((svd.right.transpose() * svd.right - identity).norm(), 1e-12);
  for (Index k = 1; k < count; ++k)
    EXPECT_LE(svd.values(k), svd.values(k - 1));
  EXPECT_GE(svd.values(count - 1), 0);
  EXPECT_LE((singular_values(matrix) - svd.values).norm(), 1e-13 * scale);
}

TEST(SmallSvd, factors_tall_wide_and_square) {
  expect_svd(testing_grid::random_matrix(30, 12, 1));
  expect_svd(testing_grid::random_matrix(12, 30, 2));
  expect_svd(1e-9 * testing_grid::random_matrix(117, 117, 3));
  expect_svd(testing_grid::random_matrix(1, 7, 4));
  expect_svd(testing_grid::random_matrix(7, 1, 5));
}

/// The object of the prefix is let go after a large matrix, and made again for the next.
TEST(SmallSvd, factors_large_matrices_one_after_the_other) {
  for (const Index columns : {330, 20, 340})
    expect_svd(testing_grid::random_matrix(350, columns, 11));
}

TEST(SmallSvd, small_values_are_not_lost) {
  // Singular values 1, 1e-4, 1e-8, 1e-12: the root of an eigenvalue of the square would stop at
  // 1e-8.
  const Matrix left = small_svd(testing_grid::random_matrix(20, 4, 6)).left;
  const Matrix right = small_svd(testing_grid::random_matrix(4, 4, 7)).left;
  const Vector exact = (Vector(4) << 1, 1e-4, 1e-8, 1e-12).finished();
  const Vector values = singular_values(left * exact.asDiagonal() * right.transpose());
  for (Index k = 0; k < 4; ++k)
    EXPECT_NEAR(values(k), exact(k), 1e-15 + 1e-3 * exact(3));
}

TEST(SmallSvd, tall_values_agree_with_one_sided_rotations) {
  for (const auto &[rows, columns] : {std::pair<Index, Index>{40, 7}, {200, 1}, {13, 12}}) {
    const Matrix matrix = testing_grid::random_matrix(rows, columns, 9);
    const Vector expected = thin_svd(matrix).values;
    EXPECT_LE((singular_values(matrix) - expected).norm(), 1e-14 * matrix.norm());
    EXPECT_LE((singular_values(matrix.transpose()) - expected).norm(), 1e-14 * matrix.norm());
  }
  // Columns of very different lengths: absolute accuracy to round-off of the largest.
  Matrix graded = testing_grid::random_matrix(60, 5, 10);
  graded *= Vector{{1, 1e-3, 1e-6, 1e-9, 1e-12}}.asDiagonal();
  const Vector expected = thin_svd(graded).values;
  EXPECT_LE((singular_values(graded) - expected).cwiseAbs().maxCoeff(), 1e-14 * graded.norm());
}

TEST(SmallSvd, rank_deficient_and_zero) {
  const Matrix factor = testing_grid::random_matrix(25, 3, 8);
  const Vector values = singular_values(factor * factor.transpose());
  EXPECT_GT(values(2), 1e-3 * values(0));
  EXPECT_LE(values(3), 1e-13 * values(0));
  EXPECT_EQ(singular_values(Matrix::Zero(4, 3)), Vector(Vector::Zero(3)));
  EXPECT_EQ(small_svd(Matrix(5, 0)).values.size(), 0);
}

TEST(SmallSvd, refuses_nan) {
  Matrix matrix = Matrix::Ones(3, 3);
  matrix(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(small_svd(matrix), Error);
}

} // namespace
} // namespace rbvi::small_svd_test
