// Contact with friction: what the solver asks for, where it starts, and when it stops.
#include "friction_problems.hpp"
#include "rbvi/core/error.hpp"

using namespace rbvi;

TEST(Friction, OnlyColumnsOfNodesThatTouchAreAskedFor) {
  const FrictionProblem p = punch(81, 2, 20, 0.1);
  const FrictionBound coulomb{0.3, 0, false};
  const FrictionResult cold = expect_solved(p, coulomb);
  EXPECT_LT(cold.columns, 100);
  const FrictionResult warm = expect_solved(p, coulomb, cold.x);
  EXPECT_EQ(warm.columns, 2 * static_cast<int>(warm.active.size()));
  // Nothing touches: nothing is asked for, unless tangential forces act across the gap.
  const FrictionProblem apart{p.h, Vector::Ones(162), 2};
  EXPECT_EQ(expect_solved(apart, coulomb).columns, 0);
  EXPECT_EQ(expect_solved(apart, {0, 0.1, true}).columns, 0);
  EXPECT_EQ(expect_solved(apart, {0, 0.1, false}).columns, 81);
}

TEST(Friction, WithoutABoundNoTangentialColumnIsAskedFor) {
  const FrictionProblem p = punch(41, 3, 12, 0.1);
  std::set<Index> given;
  ASSERT_TRUE(solve_friction(once(p.h, given), p.q, 3, {}).converged);
  EXPECT_LT(*given.rbegin(), p.nodes());
}

TEST(Friction, StartsWhereItIsTold) {
  for (const int dim : {2, 3})
    for (const FrictionBound &bound : all_bounds) {
      const FrictionProblem p = punch(61, dim, 20, 0.05);
      const FrictionResult cold = expect_solved(p, bound);
      EXPECT_EQ(expect_solved(p, bound, cold.x).iterations, 1);
      const FrictionResult warm = expect_solved(punch(61, dim, 20.5, 0.051), bound, cold.x);
      EXPECT_LT(warm.iterations, cold.iterations);
      // Not a start at all: pulling pressures, forces far beyond their bounds.
      Vector wild = Random(9).vector(61 * dim);
      EXPECT_LT((expect_solved(p, bound, wild).x - cold.x).norm(), 1e-10 * cold.x.norm());
    }
}

TEST(Friction, TheSafeguardTakesOverWhereNewtonCycles) {
  for (const int dim : {2, 3}) {
    Random random(10);
    int taken_over = 0;
    for (int k = 0; k < 60; ++k) {
      const Index n = dim * (3 + k % 12);
      const FrictionProblem p{ill_conditioned(random, n), random.vector(n), dim};
      for (const FrictionBound &bound :
           {FrictionBound{0, 0.3, false}, FrictionBound{0.2, 0, false}})
        taken_over += expect_solved(p, bound).backup_steps > 0;
    }
    EXPECT_GT(taken_over, 10);
  }
}

TEST(Friction, NeverCallsAWrongAnswerConverged) {
  Random random(11);
  int unsolved = 0;
  for (int k = 0; k < 60; ++k)
    for (const int dim : {2, 3}) {
      const Index n = dim * (3 + k % 12);
      const FrictionProblem p{ill_conditioned(random, n), random.vector(n), dim};
      const FrictionBound hard{1, 0.1, false};
      std::set<Index> given;
      const FrictionResult result =
          solve_friction(once(p.h, given), p.q, dim, hard, {}, {.max_iterations = 60});
      unsolved += !result.converged;
      EXPECT_EQ(result.converged, violation(p, hard, result.x) < 1e-12) << result.reason;
      EXPECT_EQ(result.converged, result.residual < 1e-12) << result.residual;
    }
  EXPECT_GT(unsolved, 10);
}

TEST(Friction, SaysWhyItStopped) {
  const FrictionProblem p = punch(41, 2, 12, 0.05);
  std::set<Index> given;
  const FrictionResult stopped =
      solve_friction(once(p.h, given), p.q, 2, {0.3, 0, false}, {}, {.max_iterations = 2});
  EXPECT_FALSE(stopped.converged);
  EXPECT_NE(stopped.reason.find("raise the limit"), std::string::npos) << stopped.reason;
  EXPECT_NE(stopped.reason.find("start closer"), std::string::npos) << stopped.reason;
  EXPECT_GT(stopped.residual, 1e-6);
  EXPECT_EQ(stopped.iterations, 2);
  EXPECT_EQ(stopped.x.size(), p.q.size());

  for (const int dim : {2, 3})
    for (const FrictionBound &bound : {FrictionBound{0.3, 0, false}, FrictionBound{0, 1, false}}) {
      Matrix h = Matrix::Identity(dim, dim);
      h(0, 0) = -1;
      given.clear();
      const FrictionResult indefinite =
          solve_friction(once(h, given), -Vector::Ones(dim), dim, bound);
      EXPECT_FALSE(indefinite.converged);
      EXPECT_NE(indefinite.reason.find("not positive definite"), std::string::npos);
      Matrix twice = Matrix::Ones(2 * dim, 2 * dim) + 0.5 * Matrix::Identity(2 * dim, 2 * dim);
      twice(0, 1) = twice(1, 0) = 2;
      given.clear();
      const FrictionResult dependent =
          solve_friction(once(twice, given), -Vector::Ones(2 * dim), dim, bound);
      EXPECT_FALSE(dependent.reason.empty());
    }
}

TEST(Friction, RefusesBadInput) {
  const FrictionProblem p = punch(5, 2, 2, 0.1);
  std::set<Index> given;
  const ColumnSource columns = columns_of(p.h);
  const FrictionBound coulomb{0.3, 0, false};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto status = [&](const ColumnSource &source, const Vector &q, int dim,
                          const FrictionBound &bound, const Vector &start = {}) {
    try {
      solve_friction(source, q, dim, bound, start);
    } catch (const Error &error) {
      return error.status();
    }
    return Status::done;
  };
  EXPECT_EQ(status(columns, p.q, 2, coulomb), Status::done);
  EXPECT_EQ(status(columns, p.q, 2, {-0.1, 0, false}), Status::bad_input);
  EXPECT_EQ(status(columns, p.q, 2, {0, -0.1, false}), Status::bad_input);
  EXPECT_EQ(status(columns, p.q, 2, {nan, 0, false}), Status::bad_input);
  EXPECT_EQ(status(columns, p.q, 4, coulomb), Status::failed);
  EXPECT_EQ(status(columns, p.q, 3, coulomb), Status::failed);
  EXPECT_EQ(status(columns, p.q, 2, coulomb, Vector::Zero(3)), Status::failed);
  EXPECT_EQ(status(columns, p.q, 2, coulomb, Vector::Constant(10, nan)), Status::failed);
  EXPECT_EQ(status(columns, Vector::Constant(10, nan), 2, coulomb), Status::failed);
  const ColumnSource narrow = [](const std::vector<Index> &) {
    return Matrix(Matrix::Ones(10, 0));
  };
  const ColumnSource broken = [&](const std::vector<Index> &which) {
    return Matrix(Matrix::Constant(10, static_cast<Index>(which.size()), nan));
  };
  for (const FrictionBound &bound : {coulomb, FrictionBound{}})
    for (const ColumnSource &source : {narrow, broken})
      EXPECT_EQ(status(source, p.q, 2, bound), Status::failed);
}
