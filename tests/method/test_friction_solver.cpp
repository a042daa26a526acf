// Contact with friction: what the solver asks for, where it starts, and when it stops.
#include "../../src/method/friction_newton.hpp"
#include "friction_problems.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/method/several_answers.hpp"

namespace rbvi::friction_solver_test {

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
      // In space steps by the factors of before, which are most of them, are not counted.
      EXPECT_LE(warm.iterations, cold.iterations - (dim == 2 ? 1 : 0));
      // Not a start at all: pulling pressures, forces far beyond their bounds.
      Vector wild = Random(9).vector(61 * dim);
      EXPECT_LT((expect_solved(p, bound, wild).x - cold.x).norm(), 1e-10 * cold.x.norm());
    }
}

namespace {

struct Solved {
  FrictionProblem problem;
  FrictionBound bound;
  FrictionResult result;
};

/// A gap that stays open, punches that touch more and more, and random problems (where the bound
/// jumps at the first pressure, these need not have a solution).
std::vector<Solved> solved_problems(int dim) {
  std::vector<Solved> list;
  const auto add = [&](const FrictionProblem &p, const FrictionBound &bound) {
    list.push_back({p, bound, expect_solved(p, bound)});
  };
  Random random(12);
  for (int k = 0; k < 12; ++k) {
    const Index n = dim * (1 + k);
    const Matrix h = random_positive(random, n, 1);
    const Vector q = random.vector(n);
    for (const FrictionBound &bound : all_bounds) {
      add({half_plane(1 + k, dim), Vector::Ones(n), dim}, bound);
      add(punch(41, dim, 8 + k, 0.02 * (1 + k)), bound);
      if (!bound.only_in_contact) add({h, q, dim}, bound);
    }
  }
  return list;
}

double error(const Vector &x, const Vector &expected) {
  return (x - expected).norm() / std::max(expected.norm(), std::numeric_limits<double>::min());
}

} // namespace

TEST(FrictionStart, OfItsOwnAnswerNeedsOneStep) {
  for (const int dim : {1, 2, 3})
    for (const auto &[p, bound, cold] : solved_problems(dim)) {
      const FrictionResult again = expect_solved(p, bound, cold.start);
      EXPECT_EQ(again.iterations, 1);
      EXPECT_EQ(again.states, cold.states);
      if (dim < 3)
        EXPECT_EQ(again.x, cold.x);
      else
        EXPECT_LT(error(again.x, cold.x), 1e-11);
    }
}

TEST(FrictionStart, TellsEveryState) {
  for (const int dim : {1, 2, 3}) {
    std::set<NodeState> seen;
    for (const auto &[p, bound, result] : solved_problems(dim))
      for (Index i = 0; i < p.nodes(); ++i) {
        const NodeState state = result.states[i];
        seen.insert(state);
        EXPECT_EQ(result.start[i] > 0, state != NodeState::open);
        if (dim == 1) continue;
        const Index t = p.tangent(i), count = dim - 1;
        const double limit = bound_of(bound, result.x[i]);
        const bool slips = result.start.segment(t, count).norm() >= limit;
        if (state != NodeState::open) {
          EXPECT_EQ(slips, state == NodeState::slip);
        }
        // By Tresca open nodes stick and slip too.
        EXPECT_EQ(slips, result.x.segment(t, count).norm() >= (1 - 1e-12) * limit);
      }
    EXPECT_EQ(seen.size(), dim == 1 ? 2U : 3U);
  }
}

TEST(FrictionStart, XItselfServesToo) {
  for (const int dim : {1, 2, 3})
    for (const auto &[p, bound, cold] : solved_problems(dim)) {
      const FrictionResult again = expect_solved(p, bound, cold.x);
      EXPECT_LE(again.iterations, dim < 3 ? 1 : 2);
      EXPECT_EQ(again.states, cold.states);
      EXPECT_LT(error(again.x, cold.x), 1e-11);
    }
}

/// In space, by the factors of other sets, whose slips have turned since.
TEST(FrictionStart, FactorsOfOtherSetsLeadToTheAnswer) {
  using namespace friction;
  for (const FrictionBound &bound : {FrictionBound{0.3, 0, false}, {0, 0.2, false}}) {
    const FrictionProblem before = punch(201, 3, 66, 0.05), after = punch(201, 3, 68, 0.05);
    const FrictionResult there = expect_solved(before, bound), answer = expect_solved(after, bound);
    const LazyColumns h = [&] {
      LazyColumns all(ScaledMatrix{{after.h.data(), after.h.rows(), after.h.cols()}, 1});
      std::vector<Index> every(after.q.size());
      std::iota(every.begin(), every.end(), 0);
      all.require(every);
      return all;
    }();
    const NodeLaws laws = uniform_laws(after.nodes(), 3, bound);
    const auto sets_at = [&](const Vector &start) {
      ActiveSets sets = predicted_sets(laws, start);
      set_curvature(h.diagonal(), laws, start, sets);
      return sets;
    };
    const ActiveSets known = sets_at(there.start), wanted = sets_at(answer.start);
    EXPECT_GT(known.differences(wanted), 0);
    const System system(h, laws, known);
    State point;
    ASSERT_EQ(system.step(h, after.q, laws, 0, point), friction::Solved::yes);
    EXPECT_EQ(system.step_nearby(h, after.q, laws, known, ActiveSets(laws), point),
              friction::Solved::far);
    ASSERT_EQ(system.step_nearby(h, after.q, laws, known, wanted, point), friction::Solved::yes);
    for (int k = 0; k < 20; ++k)
      ASSERT_EQ(system.step_nearby(h, after.q, laws, wanted, wanted, point), friction::Solved::yes);
    EXPECT_LT(error(point.x, answer.x), 1e-11);
  }
}

TEST(FrictionStart, OfANearbyProblemSavesSteps) {
  for (const int dim : {1, 2, 3})
    for (const FrictionBound &bound : all_bounds) {
      if (bound.only_in_contact) continue; // a problem need not have a solution
      int cold_steps = 0, warm_steps = 0;
      for (int k = 0; k < 12; ++k) {
        const FrictionProblem before = punch(41, dim, 8 + k, 0.02 * (1 + k));
        const FrictionProblem p = punch(41, dim, 8.2 + k, 0.021 * (1 + k));
        const FrictionResult cold = expect_solved(p, bound);
        const FrictionResult warm = expect_solved(p, bound, expect_solved(before, bound).start);
        EXPECT_LE(warm.iterations, cold.iterations);
        cold_steps += cold.iterations;
        warm_steps += warm.iterations;
      }
      EXPECT_LT(warm_steps, 0.75 * cold_steps);
    }
}

TEST(FrictionStart, WhereTheFirstStepIsImpossibleItSaysSo) {
  for (const int dim : {2, 3}) {
    const Vector q = -Vector::Ones(dim), start = Vector::Ones(dim);
    Matrix h = Matrix::Identity(dim, dim);
    const FrictionBound coulomb{0.3, 0, false};
    const FrictionResult none =
        solve_friction(columns_of(h), q, dim, coulomb, start, {.max_iterations = 0});
    EXPECT_FALSE(none.converged);
    EXPECT_NE(none.reason.find("raise the limit"), std::string::npos) << none.reason;
    h(0, 0) = -1;
    const FrictionResult indefinite = solve_friction(columns_of(h), q, dim, coulomb, start);
    EXPECT_FALSE(indefinite.converged);
    EXPECT_NE(indefinite.reason.find("not positive definite"), std::string::npos);
  }
}

TEST(FrictionStart, NonsenseDoesNoHarm) {
  Random random(14);
  for (const int dim : {1, 2, 3})
    for (const auto &[p, bound, cold] : solved_problems(dim)) {
      const Index n = p.q.size();
      const std::vector<Vector> starts{Vector::Ones(n),         -Vector::Ones(n),
                                       1e100 * Vector::Ones(n), -1e100 * Vector::Ones(n),
                                       1e12 * random.vector(n), 1e-100 * random.vector(n)};
      for (const Vector &start : starts) {
        const FrictionResult result = expect_solved(p, bound, start);
        // Where the bound jumps at the first pressure, there can be several solutions.
        if (!bound.only_in_contact) {
          EXPECT_LT(error(result.x, cold.x), 1e-10);
        }
      }
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

/// A soft layer between two bodies: what they slip grows along it, and the layer can slide as one.
FrictionProblem sliding_layer(Index nodes, double slides, double offset) {
  FrictionProblem p{Matrix::Zero(2 * nodes, 2 * nodes), Vector(2 * nodes), 2};
  for (Index i = 0; i < nodes; ++i) {
    for (Index j = 0; j < nodes; ++j) {
      const double near = std::exp(-std::abs(static_cast<double>(i - j)) / 3);
      p.h(i, j) = near;
      p.h(nodes + i, nodes + j) = near + slides;
      p.h(i, nodes + j) = p.h(nodes + j, i) = 0.1 * near * (i < j ? 1 : i > j ? -1 : 0);
    }
    p.q[i] = -1 - 0.3 * std::sin(static_cast<double>(i));
    p.q[nodes + i] = 0.1 * ((static_cast<double>(i) + offset) / static_cast<double>(nodes) - 0.5);
  }
  return p;
}

TEST(Friction, ALayerThatSlidesAsOneTakesFewSystems) {
  int taken_over = 0;
  for (const double slides : {1.0, 10.0, 100.0, 1000.0})
    for (const double coefficient : {0.01, 0.03, 0.1, 0.3})
      for (const double offset : {-11.3, -4.0, 0.0, 7.7}) {
        const FrictionResult result =
            expect_solved(sliding_layer(40, slides, offset), {coefficient, 0, false});
        EXPECT_LE(result.iterations, 20);
        taken_over += result.backup_steps > 0;
      }
  EXPECT_GT(taken_over, 5);
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

namespace {

/// Normal and tangential rows of each node side by side, nodes from the last to the first.
NodeLaws reversed_laws(Index nodes, int dim, const FrictionBound &bound) {
  NodeLaws laws = uniform_laws(nodes, dim, bound);
  for (Index i = 0; i < nodes; ++i) {
    laws.normal[i] = (nodes - 1 - i) * dim;
    if (dim > 1) laws.tangent[i] = laws.normal[i] + 1;
  }
  return laws;
}

/// Row j of the result is row `from[j]`.
std::vector<Index> rows_of(const NodeLaws &laws, int dim) {
  std::vector<Index> from(laws.rows);
  for (Index i = 0; i < laws.nodes(); ++i) {
    from[laws.normal[i]] = i;
    for (int k = 0; k + 1 < dim; ++k)
      from[laws.tangent[i] + k] = laws.nodes() + i * (dim - 1) + k;
  }
  return from;
}

} // namespace

TEST(Friction, NearAnAnswerItsActiveSetsTellTheNext) {
  for (const int dim : {1, 2, 3})
    for (const FrictionBound &bound : all_bounds) {
      if (bound.jumps()) continue; // held thresholds are tested by the answers of the models
      const FrictionProblem p = punch(41, dim, 12.3, 0.08);
      const NodeLaws laws = reversed_laws(p.nodes(), dim, bound);
      const std::vector<Index> rows = rows_of(laws, dim);
      Random random(5);
      const Matrix other = random_positive(random, p.q.size(), 1);
      const Vector load = random.vector(p.q.size());
      const auto problem = [&](double e) {
        const double h = e * p.h.diagonal().maxCoeff() / other.diagonal().maxCoeff();
        return FrictionProblem{Matrix((p.h + h * other)(rows, rows)),
                               Vector((p.q + e * p.q.norm() / load.norm() * load)(rows)), dim};
      };
      const auto law = [&](double e) {
        return reversed_laws(p.nodes(), dim,
                             {bound.coefficient * (1 + e), bound.threshold * (1 - e)});
      };
      const FrictionProblem here = problem(0);
      std::set<Index> given;
      FrictionSolver solver(once(here.h, given), laws);
      const FrictionAnswer answer = solver.answer(here.q, {}, false);
      ASSERT_TRUE(answer.converged) << answer.reason;
      double before = 0;
      for (const double e : {1e-5, 5e-6}) {
        const FrictionProblem there = problem(e);
        std::set<Index> unused;
        const FrictionAnswer exact =
            friction_answer(once(there.h, unused), there.q, law(e), answer.start, false);
        ASSERT_TRUE(exact.converged) << exact.reason;
        ASSERT_EQ(exact.states, answer.states) << "the test needs a smaller step";
        const NearAnswer near = solver.near(there.h * answer.x + there.q, law(e));
        EXPECT_TRUE(near.same_states);
        const double error = (near.x - exact.x).norm() / exact.x.norm();
        const double moved = (answer.x - exact.x).norm() / exact.x.norm();
        EXPECT_LT(error, 0.01 * moved) << "dim " << dim << ", coefficient " << bound.coefficient;
        if (before > 1e-12) EXPECT_NEAR(error / before, 0.25, 0.1); // it is of second order
        before = error;
      }
      FrictionSolver unsolved(once(here.h, given), laws);
      EXPECT_THROW(unsolved.near(here.q, laws), Error);
    }
}

TEST(Friction, NearAnAnswerItTellsThatANodeTouchesOrSlips) {
  const Matrix h = Matrix::Identity(2, 2);
  const NodeLaws laws = uniform_laws(1, 2, {0.3});
  const auto stays = [&](const Vector &q, const Vector &change) {
    std::set<Index> given;
    FrictionSolver solver(once(h, given), laws);
    const FrictionAnswer answer = solver.answer(q, {}, false);
    return solver.near(h * answer.x + q + change, laws).same_states;
  };
  const Vector small{{-2e-6, 2e-6}};
  EXPECT_TRUE(stays(Vector{{1e-5, 0}}, small));       // apart
  EXPECT_FALSE(stays(Vector{{1e-6, 0}}, small));      // touches
  EXPECT_TRUE(stays(Vector{{-1, 0.29999}}, small));   // sticks
  EXPECT_FALSE(stays(Vector{{-1, 0.299999}}, small)); // slips
}

} // namespace rbvi::friction_solver_test
