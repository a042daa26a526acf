#include "rbvi/method/published/collocated_friction.hpp"

#include "half_plane.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::uzawa_test {
namespace {

/// A round punch on a half-plane of m nodes, pushed along it: every node has a function of its own.
CollocatedProblem punch(Index m, const FrictionBound &bound) {
  CollocatedProblem p{half_plane(m, 2, 0.2),
                      Vector(2 * m),
                      Matrix::Identity(m, m),
                      Matrix::Identity(m, m),
                      {bound}};
  for (Index i = 0; i < m; ++i) {
    const double u =
        (static_cast<double>(i) - 0.45 * static_cast<double>(m)) / (0.3 * static_cast<double>(m));
    p.q[i] = u * u - 1;
    p.q[m + i] = 0.3 + 0.2 * std::sin(u);
  }
  return p;
}

/// Modes that are no hats, held at more nodes than there are modes.
CollocatedProblem on_few_modes(CollocatedProblem p, Index modes) {
  const Index m = p.normal_rows.cols();
  Matrix functions = Matrix::Zero(2 * m, m + modes);
  functions.topLeftCorner(m, m).setIdentity();
  for (Index k = 0; k < modes; ++k)
    for (Index i = 0; i < m; ++i)
      functions(m + i, m + k) = std::cos(3.14159 * static_cast<double>(k) *
                                         (static_cast<double>(i) + 0.5) / static_cast<double>(m));
  return {functions.transpose() * p.h * functions, functions.transpose() * p.q, p.normal_rows,
          functions.bottomRightCorner(m, modes), p.bounds};
}

CollocatedResult by_uzawa(const CollocatedProblem &p, const UzawaOptions &options) {
  return solve_collocated_by_uzawa(p, Matrix::Identity(p.q.size(), p.q.size()), options);
}

TEST(Uzawa, ItsLimitIsTheExactAnswer) {
  for (const FrictionBound &bound :
       {FrictionBound{0, 0, false}, {0.3, 0, false}, {0, 0.2, false}, {0.2, 0.1, false}})
    for (const CollocatedProblem &p : {punch(16, bound), on_few_modes(punch(16, bound), 5)}) {
      SCOPED_TRACE(std::to_string(bound.coefficient) + " " + std::to_string(bound.threshold));
      const CollocatedResult exact = solve_collocated(p);
      ASSERT_TRUE(exact.converged) << exact.reason;
      double before = std::numeric_limits<double>::infinity();
      for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12}) {
        const CollocatedResult steps = by_uzawa(p, {.tolerance = tolerance});
        ASSERT_TRUE(steps.converged) << steps.reason;
        EXPECT_LE(steps.residual, tolerance);
        const double error = (steps.x - exact.x).norm() / exact.x.norm();
        EXPECT_LT(error, before);
        before = error;
      }
      EXPECT_LE(before, 1e-9);
      const CollocatedResult accelerated = by_uzawa(p, {.tolerance = 1e-12, .accelerated = true});
      EXPECT_TRUE(accelerated.converged);
      EXPECT_LE((accelerated.x - exact.x).norm(), 1e-9 * exact.x.norm());
    }
}

/// With rho = 1 / (2 H) of a single multiplier what is left halves with every step: x_k =
/// x (1 - 2^-k), and step k changes it by the part 1 / (2^k - 1): 1e-6 at the twentieth.
TEST(Uzawa, StopsAtTheStepOfTheClosedForm) {
  const CollocatedProblem p{
      Matrix::Constant(1, 1, 2), Vector::Constant(1, -3), Matrix(0, 1), Matrix(0, 0), {}};
  const CollocatedResult steps = by_uzawa(p, {.step = 0.25});
  EXPECT_TRUE(steps.converged);
  EXPECT_EQ(steps.iterations, 20);
  EXPECT_NEAR(steps.x[0], 1.5 * (1 - std::pow(0.5, 20)), 1e-15);
  EXPECT_NEAR(steps.residual, 1 / (std::pow(2, 20) - 1), 1e-14);
}

TEST(Uzawa, NoConvergenceIsSaid) {
  const CollocatedResult steps = by_uzawa(punch(16, {0.3, 0, false}), {.max_iterations = 3});
  EXPECT_FALSE(steps.converged);
  EXPECT_EQ(steps.iterations, 3);
  EXPECT_NE(steps.reason.find("does not converge in 3 iterations"), std::string::npos);
}

TEST(Uzawa, OpensAtOnceWhereNothingTouches) {
  CollocatedProblem p = punch(8, {0.3, 0, false});
  p.q.head(8).setConstant(1);
  p.q.tail(8).setZero();
  const CollocatedResult steps = by_uzawa(p, {});
  EXPECT_TRUE(steps.converged);
  EXPECT_EQ(steps.iterations, 1);
  EXPECT_EQ(steps.x.norm(), 0);
}

} // namespace
} // namespace rbvi::uzawa_test
