// Active sets with whoever solves their systems agree with active sets that ask for columns.
#include "friction_problems.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/method/active_sets.hpp"

#include <array>
#include <barrier>
#include <thread>

namespace rbvi::active_sets_test {

namespace {

/// Solves the systems with H whole: w = H x + q.
SetSolver dense(const Matrix &h, const Vector &q, int *systems = nullptr) {
  return [&h, &q, systems](const SetSystem &system, double /*accuracy*/) {
    if (systems != nullptr) ++*systems;
    const Matrix t = system.t, r = system.r;
    const Matrix matrix = r.transpose() * h * t;
    const Vector right = -r.transpose() * (h * system.fixed + q);
    const Vector y = t.cols() > 0 ? Vector(matrix.partialPivLu().solve(right)) : Vector();
    SetSolution found;
    found.x = system.fixed;
    if (t.cols() > 0) found.x += t * y;
    found.w = h * found.x + q;
    found.terms = h.cwiseAbs() * found.x.cwiseAbs() + q.cwiseAbs();
    return found;
  };
}

FrictionResult by_sets(const FrictionProblem &p, const NodeLaws &laws, const Vector &start = {}) {
  return solve_by_sets(dense(p.h, p.q), p.h.diagonal(), laws, start);
}

} // namespace

TEST(ActiveSets, AgreeWithCondensedContactUnderEveryLaw) {
  for (const FrictionBound &bound :
       {FrictionBound{0, 0, false}, FrictionBound{0.3, 0, false}, FrictionBound{0, 0.02, false},
        FrictionBound{0.2, 0.01, false}})
    for (const double width : {4., 12., 20.}) {
      const FrictionProblem p = punch(61, 2, width, 0.05);
      const NodeLaws laws = uniform_laws(61, 2, bound);
      const FrictionResult expected = expect_solved(p, bound), found = by_sets(p, laws);
      ASSERT_TRUE(found.converged) << found.reason;
      EXPECT_LE((found.x - expected.x).norm(), 1e-11 * expected.x.norm());
      EXPECT_LE((found.w - expected.w).norm(), 1e-11 * expected.w.norm());
      EXPECT_EQ(found.active, expected.active);
      EXPECT_EQ(found.states, expected.states);
      // Once for the sets, once more as exactly as they want to be judged.
      const FrictionResult again = by_sets(p, laws, found.start);
      EXPECT_EQ(again.iterations, 2);
      EXPECT_LE((again.x - found.x).norm(), 1e-12 * found.x.norm());
    }
}

TEST(ActiveSets, NeedNoTangentialMultipliers) {
  const FrictionProblem p = punch(41, 1, 12, 0.1);
  const FrictionResult found = by_sets(p, uniform_laws(41, 1, {}));
  ASSERT_TRUE(found.converged);
  EXPECT_LE((found.x - expect_solved(p, {}).x).norm(), 1e-11 * found.x.norm());
}

TEST(ActiveSets, TheSizeOfTheDiagonalDoesNotMatter) {
  const FrictionProblem p = punch(61, 2, 20, 0.05);
  const NodeLaws laws = uniform_laws(61, 2, {0.3, 0, false});
  const FrictionResult one = by_sets(p, laws);
  for (const double factor : {0.01, 100.}) {
    const FrictionResult other = solve_by_sets(dense(p.h, p.q), factor * p.h.diagonal(), laws, {});
    ASSERT_TRUE(other.converged);
    EXPECT_LE((other.x - one.x).norm(), 1e-11 * one.x.norm());
  }
}

/// Two ranks, in threads, with the nodes of a body each: they step together, and each finds what it
/// finds alone.
TEST(ActiveSets, OfTwoRanksSettleTogether) {
  const std::array<FrictionProblem, 2> bodies{punch(41, 2, 4, 0.05), punch(61, 2, 20, 0.05)};
  const FrictionBound bound{0.3, 0, false};
  std::array<FrictionResult, 2> found;
  Vector shared;
  std::barrier all_here(2);
  const auto rank = [&](std::size_t self) {
    const LargestOverRanks largest = [&](Vector &values) {
      if (self == 0) shared = values;
      all_here.arrive_and_wait();
      if (self == 1) shared = shared.cwiseMax(values).eval();
      all_here.arrive_and_wait();
      values = shared;
      all_here.arrive_and_wait();
    };
    const FrictionProblem &p = bodies[self];
    found[self] = solve_by_sets(dense(p.h, p.q), p.h.diagonal(),
                                uniform_laws(p.q.size() / 2, 2, bound), {}, {.largest = largest});
  };
  std::thread other(rank, 1);
  rank(0);
  other.join();
  for (std::size_t self : {0, 1}) {
    const FrictionProblem &p = bodies[self];
    const FrictionResult alone = by_sets(p, uniform_laws(p.q.size() / 2, 2, bound));
    ASSERT_TRUE(found[self].converged);
    EXPECT_LE((found[self].x - alone.x).norm(), 1e-12 * alone.x.norm());
    EXPECT_EQ(found[self].states, alone.states);
    EXPECT_GE(found[self].iterations, alone.iterations);
  }
  EXPECT_EQ(found[0].iterations, found[1].iterations);
}

TEST(ActiveSets, OfNothingInContactAreOneSystem) {
  const Matrix h = Matrix::Identity(5, 5);
  const Vector q = Vector::Ones(5);
  int systems = 0;
  const FrictionResult found =
      solve_by_sets(dense(h, q, &systems), h.diagonal(), uniform_laws(5, 1, {}), {});
  ASSERT_TRUE(found.converged);
  EXPECT_EQ(found.x.norm(), 0);
  EXPECT_EQ(systems, 2); // with the accuracy while sets change, and with the last one
}

TEST(ActiveSets, SaySoWhereTheyDoNotSettle) {
  const FrictionProblem p = punch(61, 2, 20, 0.05);
  const FrictionResult stopped = solve_by_sets(
      dense(p.h, p.q), p.h.diagonal(), uniform_laws(61, 2, {}), {}, {{.max_iterations = 2}});
  EXPECT_FALSE(stopped.converged);
  EXPECT_NE(stopped.reason.find("after 2 steps"), std::string::npos) << stopped.reason;
  EXPECT_THROW(
      solve_by_sets(dense(p.h, p.q), p.h.diagonal(), uniform_laws(61, 3, {0.3, 0, false}), {}),
      Error);
}

} // namespace rbvi::active_sets_test
