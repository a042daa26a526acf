// Orthonormal columns of blocks that are all but dependent.
#include "rbvi/mor/orthonormal.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::orthonormal_test {
namespace {

/// Columns that change slowly from one to the next, in a space of `rank` dimensions.
Matrix slow_columns(Index rank, double width, unsigned seed) {
  std::srand(seed);
  const Matrix left = Matrix::Random(70, rank);
  Matrix right(rank, 102);
  for (Index i = 0; i < rank; ++i)
    for (Index j = 0; j < right.cols(); ++j) {
      const double away = (double(i) / double(rank - 1) - double(j) / 101) * double(rank) / width;
      right(i, j) = std::exp(-away * away);
    }
  return left * right;
}

/// What fits in one Gram matrix by round-off alone must not be taken for a direction.
TEST(OrthonormalColumns, AreOrthonormalHoweverDependentTheBlock) {
  for (const Index rank : {10, 20, 30, 40, 50, 60})
    for (const double width : {0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0})
      for (unsigned seed = 0; seed < 5; ++seed) {
        const Matrix x = slow_columns(rank, width, seed), q = orthonormal_range(x);
        ASSERT_LE(q.cols(), 70);
        EXPECT_LT((q.transpose() * q - Matrix::Identity(q.cols(), q.cols())).norm(), 1e-12)
            << rank << ' ' << width << ' ' << seed;
        const Matrix left = x - q * (q.transpose() * x);
        EXPECT_LT((left.colwise().norm().array() / x.colwise().norm().array()).maxCoeff(), 1e-11)
            << rank << ' ' << width << ' ' << seed;
      }
}

} // namespace
} // namespace rbvi::orthonormal_test
