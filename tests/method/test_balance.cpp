// Bodies that contact alone holds: what holds them, what can be balanced, and where forces balance.
#include "rbvi/method/balance.hpp"

#include "random_matrix.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/method/several_answers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace rbvi::balance_test {
namespace {

/// Nodes at x = 0, 1, ... of a flat foot, normals downwards: rows n . z and tau . z of the motions
/// along x, along y and about the origin.
Matrix foot(Index nodes, bool friction) {
  Matrix held = Matrix::Zero((friction ? 2 : 1) * nodes, 3);
  for (Index i = 0; i < nodes; ++i) {
    held.row(i) << 0, -1, -double(i);
    if (friction) held.row(nodes + i) << 1, 0, 0;
  }
  return held;
}

TEST(Balance, TellsTheMotionsThatNoContactResists) {
  const NodeLaws plain = uniform_laws(3, 1, {}), rough = uniform_laws(3, 2, {.coefficient = 0.3}),
                 smooth = uniform_laws(3, 2, {});
  const Matrix along = unresisted_motions(plain, foot(3, false));
  ASSERT_EQ(along.cols(), 1);
  EXPECT_NEAR(std::abs(along(0, 0)), 1, 1e-14);
  EXPECT_EQ(unresisted_motions(rough, foot(3, true)).cols(), 0);
  EXPECT_EQ(unresisted_motions(smooth, foot(3, true)).cols(), 1) << "a coefficient of zero";
  EXPECT_EQ(unresisted_motions(uniform_laws(1, 2, {.coefficient = 0.3}), foot(1, true)).cols(), 1)
      << "one node is turned about";
  EXPECT_EQ(unresisted_motions(plain, Matrix::Zero(3, 3)).cols(), 3);
}

TEST(Balance, AnAnswerHoldsWhereItCarriesAndSticks) {
  const NodeLaws laws = uniform_laws(3, 2, {.coefficient = 0.5});
  const Matrix held = foot(3, true);
  Vector x(6);
  x << 1, 0, 1, 0.1, 0, 0.1;
  EXPECT_EQ(loose_motions(laws, held, x).cols(), 0);
  x << 1, 0, 1, 0.5, 0, 0.5; // slips: held against nothing along x
  EXPECT_EQ(loose_motions(laws, held, x).cols(), 1);
  x << 1, 0, 0, 0.1, 0, 0; // one node carries
  EXPECT_EQ(loose_motions(laws, held, x).cols(), 1);
  EXPECT_EQ(loose_motions(laws, held, Vector::Zero(6)).cols(), 3);
}

/// Loads on a foot between x = 0 and 2: down, with a resultant between its ends and inside the cone
/// of friction.
TEST(Balance, ALoadIsBalancedInTheConeOfFriction) {
  const NodeLaws laws = uniform_laws(3, 2, {.coefficient = 0.5});
  const Matrix held = foot(3, true);
  const auto left = [&](double along, double down, double at) {
    Vector load(3);
    load << along, -down, -down * at;
    return unbalanced_load(laws, held, load, load.cwiseAbs()).norm();
  };
  EXPECT_EQ(left(0, 1, 1), 0);
  EXPECT_EQ(left(0.5, 1, 0.3), 0) << "on the cone";
  EXPECT_EQ(left(-0.49, 1, 2), 0);
  EXPECT_GT(left(0.6, 1, 1), 0.05) << "slides";
  EXPECT_GT(left(0, 1, 2.2), 0.05) << "tips";
  EXPECT_GT(left(0, -1, 1), 0.5) << "is lifted";
  Vector round_off(3);
  round_off << 0, 1e-13, 0;
  EXPECT_EQ(unbalanced_load(laws, held, round_off, Vector::Ones(3)).norm(), 0);
}

/// In space it is a cone about a circle: what slides along an axis slides along all directions.
TEST(Balance, TheConeOfFrictionIsRound) {
  const NodeLaws laws = uniform_laws(1, 3, {.coefficient = 0.5});
  Matrix held = Matrix::Identity(3, 3); // rows: normal, two tangents; motions along them
  for (const double angle : {0.0, 0.1, 0.7853981633974483, 2.0}) {
    const auto left = [&](double pull) {
      const Vector load{{-1, pull * std::cos(angle), pull * std::sin(angle)}};
      return unbalanced_load(laws, held, -load, load.cwiseAbs()).norm();
    };
    EXPECT_EQ(left(0.4999), 0) << angle;
    EXPECT_GT(left(0.51), 1e-4) << angle;
  }
}

/// H = H_0 + D D^T with springs of stiffness 1, D the motions on m nodes: at beta
/// w = H x + q - D (beta + load), lengths = beta + load - D^T x.
struct Problem {
  Matrix elastic, held;
  Vector gap, load;
  NodeLaws laws;
  bool slopes = false;
  Vector x{}, w{};

  SpringState at(const Vector &beta) {
    const Matrix h = elastic + held * held.transpose();
    const Vector q = gap - held * (beta + load);
    FrictionSolver solver(
        [&](const std::vector<Index> &which) { return Matrix(h(Eigen::all, which)); }, laws);
    const FrictionAnswer answer = solver.answer(q, {}, false);
    EXPECT_TRUE(answer.converged);
    x = answer.x;
    w = answer.w;
    SpringState state{beta + load - held.transpose() * x,
                      forces_on_motions(laws, held, load.cwiseAbs(), x).norm()};
    if (slopes) state.slope = -held.transpose() * solver.change(-held, true);
    return state;
  }
};

Matrix compliance(Index size, unsigned seed) {
  const Matrix factor = Random(seed).matrix(size, size);
  return 0.1 * (factor * factor.transpose() / double(size) + Matrix::Identity(size, size));
}

TEST(Balance, IsFoundForBodiesThatTouchThatOverlapAndThatFly) {
  for (const bool friction : {false, true})
    for (const double gap : {0.0, -0.5, 3.0}) {
      const Index nodes = 8;
      const NodeLaws laws =
          uniform_laws(nodes, friction ? 2 : 1, {.coefficient = friction ? 0.4 : 0.0});
      Matrix held = foot(nodes, friction) / 3;
      if (!friction) held = held.rightCols(2).eval();
      Vector load(held.cols());
      if (friction)
        load << 0.2, -1, -3;
      else
        load << -1, -3;
      Problem problem{compliance(held.rows(), 5), held, Vector::Zero(held.rows()), load, laws};
      problem.gap.head(nodes).setConstant(gap);
      const auto lengths = [&](const Vector &beta) { return problem.at(beta); };
      const Balance found = find_balance(Vector::Zero(load.size()), lengths);
      ASSERT_TRUE(found.converged) << friction << ' ' << gap;
      if (friction) {
        problem.slopes = true;
        const Balance sooner = find_balance(Vector::Zero(load.size()), lengths);
        ASSERT_TRUE(sooner.converged) << gap;
        EXPECT_LT(sooner.solves, found.solves) << gap;
        EXPECT_LE((sooner.beta - found.beta).norm(), 1e-9) << gap;
      }
      EXPECT_LE(found.solves, 20) << friction << ' ' << gap;
      EXPECT_LE((load - held.transpose() * problem.x).norm(), 1e-9);
      // Without springs: the laws at w = H_0 x + gap - D beta.
      const Vector w = problem.elastic * problem.x + problem.gap - held * found.beta;
      EXPECT_LE((w - problem.w).norm(), 1e-9 * (1 + gap));
    }
}

/// What touches is so soft beside the springs that a solve leaves 99 % of what it found.
TEST(Balance, IsFoundOnSomethingSoft) {
  const Matrix held = foot(8, true).leftCols(1) / 3;
  for (const double softness : {500.0, 5e5})
    for (const double along : {0.0, 0.004}) {
      Problem problem{softness * compliance(16, 5), held, Vector::Zero(16),
                      Vector::Constant(1, along), uniform_laws(8, 2, {.coefficient = 0.4})};
      problem.gap.head(8).setConstant(-softness / 1000);
      const Balance found =
          find_balance(Vector::Zero(1), [&](const Vector &beta) { return problem.at(beta); });
      ASSERT_TRUE(found.converged) << softness << ' ' << along;
      EXPECT_LE(found.solves, 8) << softness << ' ' << along;
      EXPECT_LE(std::abs(along - held.col(0).dot(problem.x)), 1e-12);
    }
}

/// So far away that round-off hides what is left.
TEST(Balance, IsNotWhereLengthsCannotTellIt) {
  const Balance found = find_balance(Vector::Constant(1, 1e17), [](const Vector &beta) {
    return SpringState{beta + Vector::Constant(1, 0.6), 1};
  });
  EXPECT_FALSE(found.converged);
}

TEST(Balance, ThatIsNotThereIsNotFound) {
  const NodeLaws laws = uniform_laws(4, 1, {});
  Vector load(2);
  load << 1, 0; // lifts
  Problem problem{compliance(4, 3), foot(4, false).rightCols(2), Vector::Zero(4), load, laws};
  const Balance found =
      find_balance(Vector::Zero(2), [&](const Vector &beta) { return problem.at(beta); });
  EXPECT_FALSE(found.converged);
  EXPECT_TRUE(found.flies);
  EXPECT_GT(found.excess.norm(), 0.5);
}

/// Two motions, each held by x + x^5, with no answer where one is further than 1.1.
class Stiffening {
public:
  explicit Stiffening(double load) : load_(load) {}
  SpringState operator()(const Vector &beta) {
    last = beta;
    ++solves;
    if (beta.maxCoeff() > 1.1) throw failure("no answer here");
    const Vector held = beta.array() + beta.array().pow(5);
    return {beta + Vector::Constant(2, load_) - coupling_ * held, load_};
  }
  Vector last;
  int solves = 0;

private:
  double load_;
  Matrix coupling_ = Matrix{{1, 0.3}, {-0.2, 1}};
};

TEST(Balance, IsFoundBesideContactProblemsWithoutAnswer) {
  Stiffening lengths(1.2);
  const Balance found = find_balance(Vector::Zero(2), std::ref(lengths));
  ASSERT_TRUE(found.converged);
  EXPECT_EQ(found.solves, lengths.solves);
  EXPECT_EQ(found.beta, lengths.last) << "the last one asked for";
  EXPECT_LE((lengths(found.beta).lengths - found.beta).norm(), 1e-10);
}

/// One motion along which forces are constant on plateaus between steep parts, and turn back once:
/// Newton's steps from plateau to plateau never end.
double bent(double x) {
  const std::vector<std::pair<double, double>> corners{
      {-2, -2},   {-0.5, -0.4}, {0, -0.4},  {0.01, 0.3},   {0.3, 0.3}, {0.31, 0.1},
      {0.6, 0.1}, {0.602, 0.9}, {1.5, 0.9}, {1.505, 1.01}, {3, 1.2}};
  std::size_t k = 1;
  while (k + 2 < corners.size() && x > corners[k].first)
    ++k;
  const auto [a, fa] = corners[k - 1];
  const auto [b, fb] = corners[k];
  return fa + (x - a) / (b - a) * (fb - fa);
}

TEST(Balance, IsFoundPastPlateausAndAWayBack) {
  for (const double load : {0.05, 0.5, 0.95, 1.1}) {
    Vector first;
    for (const double scale : {1.0, 1e-6, 3e5}) { // proportional loads, proportional answers
      const Balance found = find_balance(Vector::Zero(1), [&](const Vector &beta) {
        const double force = bent(beta[0] / scale);
        return SpringState{beta + Vector::Constant(1, scale * (load - force)), scale};
      });
      ASSERT_TRUE(found.converged) << load << ' ' << scale;
      EXPECT_NEAR(bent(found.beta[0] / scale), load, 1e-10) << scale;
      if (first.size() == 0) first = found.beta;
      EXPECT_NEAR(found.beta[0] / scale, first[0], 1e-9) << load << ' ' << scale;
    }
  }
}

TEST(Balance, IsNotFoundWhereTheContactProblemHasNoAnswer) {
  Stiffening lengths(6);
  EXPECT_FALSE(find_balance(Vector::Zero(2), std::ref(lengths)).converged);
  EXPECT_THROW(find_balance(Vector::Constant(2, 2), std::ref(lengths)), Error) << "the first one";
}

} // namespace
} // namespace rbvi::balance_test
