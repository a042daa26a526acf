// A guess between scattered samples.
#include "rbvi/core/box.hpp"

#include <gtest/gtest.h>

#include <random>

namespace rbvi::local_fit_test {
namespace {

Matrix scattered(Index d, Index count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> position;
  return Matrix::NullaryExpr(d, count, [&] { return position(random); });
}

TEST(LocalFit, IsExactForAffineFunctions) {
  for (const Index d : {1, 2, 3, 5}) {
    const Matrix points = scattered(d, 80), slopes = scattered(4, d);
    const Vector shift = Vector::LinSpaced(4, -1, 2), here = Vector::Constant(d, 0.45);
    const Matrix values = (slopes * points).colwise() + shift;
    EXPECT_LE((local_fit(values, points, here) - slopes * here - shift).norm(), 1e-8) << d;
  }
}

TEST(LocalFit, ConvergesAtSecondOrderForSmoothOnes) {
  const auto error = [](Index count) {
    const Matrix points = Vector::LinSpaced(count, 0, 1).transpose();
    const Matrix values = points.array().sin();
    double worst = 0;
    for (const double x : {0.123, 0.456, 0.789})
      worst = std::max(
          worst, std::abs(local_fit(values, points, Vector::Constant(1, x))[0] - std::sin(x)));
    return worst;
  };
  EXPECT_LE(error(41), error(11) / 8);
}

TEST(LocalFit, ASampleGivesItself) {
  const Matrix points = scattered(2, 20), values = scattered(3, 20);
  EXPECT_EQ(local_fit(values, points, points.col(7)), values.col(7));
}

/// Too few samples, samples on a line or in one point, a point far outside: the nearest.
TEST(LocalFit, TakesTheNearestWhereAFitSaysNothing) {
  const Matrix few = scattered(3, 2), values = scattered(2, 2);
  const Vector here = few.col(1) + Vector::Constant(3, 1e-3);
  EXPECT_EQ(local_fit(values, few, here), values.col(1));
  EXPECT_EQ(local_fit(values.leftCols(1), few.leftCols(1), here), values.col(0));

  const Matrix one = Matrix::Constant(2, 9, 0.5), alike = Matrix::Constant(4, 9, 2.5);
  EXPECT_LE((local_fit(alike, one, Vector::Constant(2, 0.6)) - alike.col(0)).norm(), 1e-8);

  const Matrix line = Vector::LinSpaced(9, 0, 1).transpose();
  EXPECT_EQ(local_fit(line, line, Vector::Constant(1, 50))[0], 1);
}

} // namespace
} // namespace rbvi::local_fit_test
