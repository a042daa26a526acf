// Relative errors of answers that are zero, and of answers that there are not.
#include "../model/synthetic.hpp"
#include "rbvi/study/errors.hpp"

#include <gtest/gtest.h>

namespace rbvi::errors_test {
namespace {

const double inf = std::numeric_limits<double>::infinity();

TEST(RelativeError, IsOnTheScaleOfTheSetWhereASizeIsNearlyZero) {
  EXPECT_EQ(relative(0.5, 10, 20), 0.05);
  EXPECT_EQ(relative(0.5, 0, 20), 0.5 / 0.2);
  EXPECT_EQ(relative(0, 0, 20), 0);
  EXPECT_EQ(relative(0, 0, 0), 0);
  EXPECT_EQ(relative(0.5, 0, 0), 0.5);
}

/// Nothing moves and nothing touches at the second of three parameters.
TEST(ModelErrors, AreNumbersWhereTheAnswerIsZero) {
  const ReducedModel model = synthetic::random_model({3, 2, 4, 3, 1, 1, 2}, 21);
  OnlineSolver solver(model);
  const std::vector<Mu> set{{0.2, 0, 0}, {0.18, 0.01, 0}, {0.22, 0, 0.03}};
  Truths truths{set, Matrix(5, 3), Vector::Zero(3), Vector(3), Matrix(3, 3), Vector(3), {}, {}};
  const SparseMatrix w = Matrix(Matrix::Identity(3, 3)).sparseView();
  for (Index p = 0; p < 3; ++p) {
    const ReducedAnswer solution = solver.solve(set[p]);
    const double size = p == 1 ? 0 : 1;
    truths.coordinates.col(p) = size * solution.u;
    truths.lambda.col(p) = size * solver.multiplier(solution);
    truths.u_norm[p] = truths.coordinates.col(p).norm();
    truths.lambda_norm[p] = truths.lambda.col(p).norm();
  }
  truths.largest_u = truths.u_norm.maxCoeff();
  truths.largest_lambda = truths.lambda_norm.maxCoeff();
  const ModelErrors errors = model_errors(model, {}, truths, w);
  EXPECT_EQ(errors.failed, 0);
  EXPECT_LE(errors.u[0] + errors.u[2] + errors.lambda[0] + errors.lambda[2], 1e-12);
  const ReducedAnswer wrong = solver.solve(set[1]);
  EXPECT_NEAR(errors.u[1], wrong.u.norm() / (1e-2 * truths.largest_u), 1e-9 * errors.u[1]);
  EXPECT_GT(errors.lambda[1], 0);
  EXPECT_TRUE(errors.lambda.allFinite() && errors.u_floor.allFinite() &&
              errors.lambda_floor.allFinite());
  const ValidationErrors summed = summary({&errors});
  EXPECT_EQ(summed.count, 3);
  EXPECT_NEAR(summed.u_mean, errors.u.mean(), 1e-12 * summed.u_mean);
  EXPECT_EQ(summed.u_max, errors.u[1]);
}

TEST(ModelErrors, SummariesCountQueriesWithoutAnAnswerAndLeaveThemOut) {
  ModelErrors one, other;
  one.u = Vector{{0.1, inf, 0.3}};
  one.lambda = Vector{{0.2, inf, 0.4}};
  other.u = Vector{{0.5}};
  other.lambda = Vector{{0}};
  const ValidationErrors both = summary({&one, &other});
  EXPECT_EQ(both.count, 3);
  EXPECT_EQ(both.unanswered, 1);
  EXPECT_NEAR(both.u_mean, 0.3, 1e-15);
  EXPECT_EQ(both.u_max, 0.5);
  EXPECT_NEAR(both.lambda_mean, 0.2, 1e-15);
  EXPECT_EQ(both.tangential_max, -1);
  one.u.setConstant(inf);
  const ValidationErrors none = summary({&one});
  EXPECT_EQ(none.count, 0);
  EXPECT_EQ(none.unanswered, 3);
  EXPECT_EQ(none.u_max, -1);
}

TEST(SlowQuery, IsToldWhereASolveIsHardlySlower) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(slow_query(0.001, 0.1), "");
  EXPECT_EQ(slow_query(0.1, 0), ""); // all solves were those of an earlier run
  EXPECT_EQ(slow_query(nan, 0.1), "");
  const std::string told = slow_query(0.205, 0.263);
  EXPECT_TRUE(told.starts_with("a query takes 205 ms, a high-fidelity solve 263 ms: ")) << told;
  EXPECT_NE(told.find("-cone_level"), std::string::npos) << told;
}

} // namespace
} // namespace rbvi::errors_test
