// Contact with friction: the answers, against the laws, other solvers and what is known by hand.
#include "../linear_algebra.hpp"
#include "friction_problems.hpp"

#include <optional>

namespace rbvi::friction_test {

TEST(Friction, LawsHoldForRandomProblems) {
  Random random(1);
  for (int k = 0; k < 60; ++k)
    for (const int dim : {2, 3}) {
      const Index n = dim * (1 + k % 15);
      const double least = std::pow(10, -(k % 4) * 2);
      const FrictionProblem p{random_positive(random, n, least), random.vector(n), dim};
      for (const FrictionBound &bound : all_bounds)
        // Where the bound jumps at the first pressure, a problem need not have a solution.
        if (!bound.only_in_contact) expect_solved(p, bound);
    }
}

TEST(Friction, LawsHoldForAPunchOnAHalfPlane) {
  for (const int dim : {2, 3})
    for (const double slide : {0.01, 0.05, 0.2, 1.0})
      for (const FrictionBound &bound : all_bounds) {
        const FrictionProblem p = punch(41, dim, 12, slide);
        const FrictionResult result = expect_solved(p, bound);
        EXPECT_EQ(result.backup_steps, 0);
        EXPECT_LT(result.iterations, 25);
      }
}

TEST(Friction, LawsHoldForIllConditionedMatrices) {
  Random random(2);
  for (int k = 0; k < 40; ++k)
    for (const int dim : {2, 3}) {
      const Index n = dim * (2 + k % 8);
      const FrictionProblem p{ill_conditioned(random, n), random.vector(n), dim};
      for (const FrictionBound &bound :
           {FrictionBound{0.1, 0, false}, FrictionBound{0, 0.1, false}})
        expect_solved(p, bound);
    }
}

namespace {

/// The stated fixed point, repeated with a fixed small rho until nothing moves.
Vector uzawa(const FrictionProblem &p, const FrictionBound &bound) {
  const double rho = 0.9 / p.h.operatorNorm();
  Vector x = Vector::Zero(p.q.size());
  for (int k = 0; k < 100000; ++k) {
    const Vector y = x - rho * (p.h * x + p.q);
    Vector next = y.cwiseMax(0.0);
    for (Index i = 0; i < p.nodes(); ++i)
      next.segment(p.tangent(i), p.dim - 1) =
          projected(y.segment(p.tangent(i), p.dim - 1), bound_of(bound, next[i]));
    const double change = (next - x).norm();
    x = next;
    if (change <= 1e-15 * x.norm()) break;
  }
  return x;
}

/// Solves for one state per node (0 open, 1 stick, 2 and 3 slip, to either side; the states of
/// Tresca in open nodes are 4 stick, 5 and 6 slip; 7 and 8 slip without a
/// pressure, as they adhere) and returns x if it has these states. d = 2.
std::optional<Vector> solution_of(const FrictionProblem &p, const FrictionBound &bound,
                                  const std::vector<int> &states) {
  const Index m = p.nodes(), n = 2 * m;
  Matrix a = Matrix::Identity(n, n);
  Vector right = Vector::Zero(n);
  for (Index i = 0; i < m; ++i) {
    const int state = states[i];
    if ((state >= 1 && state <= 3) || state >= 7) {
      a.row(i) = p.h.row(i);
      right[i] = -p.q[i];
    }
    if (state == 1 || state == 4) {
      a.row(m + i) = p.h.row(m + i);
      right[m + i] = -p.q[m + i];
    }
    const double sign = state == 2 || state == 5 || state == 7 ? 1 : -1;
    if (state == 2 || state == 3) a(m + i, i) = -sign * bound.coefficient;
    if (state == 2 || state == 3)
      right[m + i] = sign * (bound.threshold - bound.coefficient * bound.pull);
    if (state >= 5) right[m + i] = sign * bound.threshold;
  }
  Vector x = solved(a, right);
  for (Index i = 0; i < m; ++i) {
    const int state = states[i];
    if (state == 0 || (state > 3 && state < 7)) x[i] = 0;
    if (state == 0) x[m + i] = 0;
  }
  return violation(p, bound, x) < 1e-11 ? std::optional(x) : std::nullopt;
}

std::vector<Vector> all_solutions(const FrictionProblem &p, const FrictionBound &bound) {
  std::vector<Vector> result;
  const int kinds = bound.pull > 0 ? 9 : bound.threshold > 0 && !bound.only_in_contact ? 7 : 4;
  std::vector<int> states(p.nodes(), 0);
  for (;;) {
    if (const auto x = solution_of(p, bound, states)) result.push_back(*x);
    auto digit = states.begin();
    while (digit != states.end() && ++*digit == kinds)
      *digit++ = 0;
    if (digit == states.end()) return result;
  }
}

} // namespace

TEST(Friction, AgreesWithTheFixedPointOfItsDefinition) {
  Random random(3);
  for (int k = 0; k < 12; ++k)
    for (const int dim : {2, 3})
      for (const FrictionBound &bound :
           {FrictionBound{0.15, 0, false}, FrictionBound{0, 0.2, false},
            FrictionBound{0.1, 0.1, false}, FrictionBound{0.15, 0, false, 0.1}}) {
        const Index n = dim * (1 + k);
        const FrictionProblem p{random_positive(random, n, 0.5 * static_cast<double>(n)),
                                static_cast<double>(n) * random.vector(n), dim};
        const Vector expected = uzawa(p, bound);
        ASSERT_LT(violation(p, bound, expected), 1e-12);
        EXPECT_LT((expect_solved(p, bound).x - expected).norm(), 1e-10 * (1 + expected.norm()));
      }
}

/// Coulomb's bound up to a limit: some nodes slip below it, others at it.
TEST(Friction, ABoundMayHaveALimit) {
  Random random(17);
  for (int k = 0; k < 60; ++k)
    for (const int dim : {2, 3}) {
      const Index n = dim * (1 + k % 15);
      const FrictionProblem p{random_positive(random, n, std::pow(10, -(k % 4) * 2)),
                              random.vector(n), dim};
      for (const double limit : {0.3, 0.03, 0.0})
        for (const double threshold : {0.0, 0.02})
          expect_solved(p, {0.3, threshold, false, limit});
    }
  for (const int dim : {2, 3})
    for (const double slide : {0.05, 0.2, 1.0}) {
      const FrictionProblem p = punch(41, dim, 12, slide);
      const FrictionResult coulomb = expect_solved(p, {0.3, 0, false});
      const double highest = 0.3 * coulomb.x.head(p.nodes()).maxCoeff();
      const Vector x = expect_solved(p, {0.3, 0, false, 1.001 * highest}).x;
      EXPECT_LT((x - coulomb.x).norm(), 1e-12 * x.norm()) << "steps on the way may meet the limit";
      const FrictionResult capped = expect_solved(p, {0.3, 0, false, highest / 2});
      EXPECT_EQ(capped.backup_steps, 0);
      EXPECT_LT(capped.iterations, 25);
      int below = 0, at_it = 0;
      for (Index i = 0; i < p.nodes(); ++i)
        if (capped.states[i] == NodeState::slip)
          ++(0.3 * capped.x[i] < highest / 2 ? below : at_it);
      EXPECT_GT(below, 0);
      EXPECT_GT(at_it, 0);
    }
}

TEST(Friction, FindsOneOfTheSolutionsThatEnumerationFinds) {
  Random random(4);
  int without_solution = 0;
  for (int k = 0; k < 300; ++k) {
    const Index n = 2 * (1 + k % 3);
    const FrictionProblem p{random_positive(random, n, 1e-2), random.vector(n), 2};
    for (const FrictionBound &bound : all_bounds) {
      const std::vector<Vector> solutions = all_solutions(p, bound);
      std::set<Index> given;
      const FrictionResult result = solve_friction(once(p.h, given), p.q, 2, bound);
      EXPECT_EQ(result.converged, !solutions.empty()) << k << " " << result.reason;
      without_solution += solutions.empty();
      EXPECT_TRUE(!solutions.empty() || bound.only_in_contact);
      if (solutions.empty() && bound.coefficient == 0) {
        EXPECT_NE(result.reason.find("and neither is an answer"), std::string::npos)
            << k << " " << result.reason;
      }
      if (!result.converged) continue;
      EXPECT_TRUE(std::any_of(solutions.begin(), solutions.end(), [&](const Vector &x) {
        return (x - result.x).norm() <= 1e-10 * (1 + x.norm());
      }));
    }
  }
  EXPECT_GT(without_solution, 0);
}

/// Where nodes adhere, x_n counts from the least pressure, and the bound begins at the pull.
const FrictionBound adhesive[] = {
    {.coefficient = 0.3, .pull = 0.5},
    {.coefficient = 0.8, .pull = 0.1},
    {.coefficient = 0.3, .threshold = 0.1, .pull = 0.3},
    {.coefficient = 0.3, .limit = 0.05, .pull = 0.2},
    {.threshold = 0.2, .pull = 0.3},
};

TEST(Friction, NodesThatAdhereSlideUntilTheyArePressed) {
  Random random(23);
  std::array<int, 3> counts{}; // open, adhering, pressed
  for (int k = 0; k < 60; ++k)
    for (const int dim : {2, 3}) {
      const Index n = dim * (1 + k % 15);
      const FrictionProblem p{random_positive(random, n, std::pow(10, -(k % 4) * 2)),
                              random.vector(n), dim};
      for (const FrictionBound &bound : adhesive) {
        const FrictionResult result = expect_solved(p, bound);
        for (Index i = 0; i < p.nodes(); ++i) {
          ++counts[result.x[i] == 0 ? 0 : result.x[i] <= bound.pull ? 1 : 2];
          if (result.x[i] <= bound.pull && bound.threshold == 0) {
            EXPECT_EQ(result.x.segment(p.tangent(i), dim - 1).norm(), 0);
          }
        }
      }
    }
  for (const int count : counts)
    EXPECT_GT(count, 100) << "there is something of each";
}

TEST(Friction, WithAdhesionFindsOneOfTheSolutionsThatEnumerationFinds) {
  Random random(24);
  for (int k = 0; k < 100; ++k) {
    const Index n = 2 * (1 + k % 3);
    const FrictionProblem p{random_positive(random, n, 1e-2), random.vector(n), 2};
    for (const FrictionBound &bound : {adhesive[0], adhesive[1], adhesive[2], adhesive[4]}) {
      const std::vector<Vector> solutions = all_solutions(p, bound);
      std::set<Index> given;
      const FrictionResult result = solve_friction(once(p.h, given), p.q, 2, bound);
      ASSERT_TRUE(result.converged) << k << " " << result.reason;
      EXPECT_TRUE(std::any_of(solutions.begin(), solutions.end(), [&](const Vector &x) {
        return (x - result.x).norm() <= 1e-10 * (1 + x.norm());
      }));
    }
  }
}

/// At rest the pressure is zero and x_n the pull, to round-off, at every node: neither side of the
/// kink is tried over and over again.
TEST(Friction, AtTheKinkOfAdhesionItSettles) {
  Random random(25);
  for (const Index m = 12; const int dim : {2, 3}) {
    FrictionProblem p{random_positive(random, dim * m, 1), Vector::Zero(dim * m), dim};
    const FrictionBound bound{.coefficient = 0.5, .pull = 0.4};
    Vector x = Vector::Zero(dim * m);
    x.head(m).setConstant(bound.pull);
    p.q = -p.h * x;
    for (Index i = 0; i < m; ++i)
      p.q[p.tangent(i)] += 0.1;
    const FrictionResult result = expect_solved(p, bound);
    EXPECT_LT((result.x - x).norm(), 1e-12);
    EXPECT_EQ(result.backup_steps, 0);
    EXPECT_LT(result.iterations, 10);
  }
}

TEST(Friction, WithoutABoundItIsTheNormalProblem) {
  Random random(5);
  for (int k = 0; k < 20; ++k)
    for (const int dim : {2, 3}) {
      const Index m = 1 + k, n = dim * m;
      const FrictionProblem p{random_positive(random, n, 1e-2), random.vector(n), dim};
      const FrictionResult result = expect_solved(p, {});
      const Matrix normal = p.h.topLeftCorner(m, m);
      std::set<Index> given;
      const LcpResult expected = solve_lcp(once(normal, given), p.q.head(m), {});
      EXPECT_EQ(result.active, expected.active);
      EXPECT_EQ(result.x.head(m), expected.x);
      EXPECT_EQ(result.x.tail(n - m), Vector::Zero(n - m));
      EXPECT_EQ(result.iterations, expected.iterations);
      EXPECT_EQ(result.columns, expected.columns);
      // Warm too.
      EXPECT_EQ(expect_solved(p, {}, result.x).iterations, 1);
    }
}

TEST(Friction, AHugeCoefficientSticks) {
  for (const int dim : {2, 3}) {
    const FrictionProblem p = punch(41, dim, 12, 0.05);
    const FrictionResult result = expect_solved(p, {1e3, 0, false});
    std::vector<Index> entries = result.active;
    for (const Index i : result.active) {
      // The outermost nodes carry next to no pressure and may slip all the same.
      if (i == result.active.front() || i == result.active.back()) continue;
      EXPECT_EQ(result.states[i], NodeState::stick);
      EXPECT_LT(result.w.segment(p.tangent(i), dim - 1).norm(), 1e-12);
    }
    for (const Index i : result.active)
      for (int k = 0; k < dim - 1; ++k)
        entries.push_back(p.tangent(i) + k);
    const Vector glued = -Matrix(p.h(entries, entries)).llt().solve(Vector(p.q(entries)));
    EXPECT_LT((Vector(result.x(entries)) - glued).norm(), 1e-10 * glued.norm());
  }
}

TEST(Friction, ThresholdsFromZeroToHuge) {
  for (const int dim : {2, 3}) {
    const FrictionProblem p = punch(41, dim, 12, 0.05);
    const Vector frictionless = expect_solved(p, {}).x;
    EXPECT_LT((expect_solved(p, {0, 1e-9, false}).x - frictionless).norm(),
              1e-6 * frictionless.norm());
    for (const bool only_in_contact : {false, true}) {
      const FrictionResult held = expect_solved(p, {0, 1e6, only_in_contact});
      for (Index i = 0; i < p.nodes(); ++i) {
        const bool touches = held.x[i] > 0;
        EXPECT_EQ(held.states[i], touches ? NodeState::stick : NodeState::open);
        const double slip = held.w.segment(p.tangent(i), dim - 1).norm();
        if (touches || !only_in_contact)
          EXPECT_LT(slip, 1e-12);
        else
          EXPECT_EQ(held.x.segment(p.tangent(i), dim - 1).norm(), 0);
      }
    }
  }
}

TEST(Friction, OpenNodesOfATrescaProblemCanCarryTangentialForces) {
  Random random(6);
  for (const int dim : {2, 3}) {
    const Index m = 6, n = dim * m;
    FrictionProblem p{random_positive(random, n, 0.1), random.vector(n), dim};
    p.h.topRightCorner(m, n - m).setZero();
    p.h.bottomLeftCorner(n - m, m).setZero();
    p.q.head(m).setOnes();
    const FrictionResult result = expect_solved(p, {0, 0.05, false});
    EXPECT_TRUE(result.active.empty());
    for (Index i = 0; i < m; ++i)
      EXPECT_GT(result.x.segment(p.tangent(i), dim - 1).norm(), 0);
    // All stick: the tangential part alone.
    const FrictionResult held = expect_solved(p, {0, 1e3, false});
    const Vector expected =
        -p.h.bottomRightCorner(n - m, n - m).llt().solve(Vector(p.q.tail(n - m)));
    EXPECT_LT((held.x.tail(n - m) - expected).norm(), 1e-12 * expected.norm());
  }
}

TEST(Friction, OneNodeByHand) {
  // x_n = 2; without a bound x_tau would be -1.
  const FrictionProblem p{Matrix::Identity(2, 2), Vector{{-2, 1}}, 2};
  const FrictionResult slip = expect_solved(p, {0.25, 0, false});
  EXPECT_EQ(slip.x, (Vector{{2, -0.5}}));
  EXPECT_EQ(slip.w, (Vector{{0, 0.5}}));
  EXPECT_EQ(slip.states, std::vector{NodeState::slip});
  const FrictionResult stick = expect_solved(p, {1, 0, false});
  EXPECT_EQ(stick.x, (Vector{{2, -1}}));
  EXPECT_EQ(stick.states, std::vector{NodeState::stick});
  // In between, exactly on the edge of both.
  EXPECT_EQ(expect_solved(p, {0.5, 0, false}).x, (Vector{{2, -1}}));
  EXPECT_EQ(expect_solved(p, {0, 0.25, false}).x, (Vector{{2, -0.25}}));
  // In three dimensions the force opposes the slip (3, 4) / 5.
  const FrictionProblem disk{Matrix::Identity(3, 3), Vector{{-1, 3, 4}}, 3};
  EXPECT_LT((expect_solved(disk, {0.5, 0, false}).x - Vector{{1, -0.3, -0.4}}).norm(), 1e-14);
  EXPECT_TRUE(solve_friction({}, Vector(), 2, {0.3, 0, false}).converged);
}

TEST(Friction, NodesOnTheEdgeBetweenTwoStatesDoNotMakeItCycle) {
  Random random(7);
  for (int k = 0; k < 100; ++k)
    for (const int dim : {2, 3}) {
      // Constructed: every third node touches without pressure, every second sticks at its bound.
      const Index m = 12, n = dim * m;
      const Matrix h = random_positive(random, n, 1);
      const double coefficient = 0.2;
      Vector x = Vector::Zero(n), w = Vector::Zero(n);
      FrictionProblem p{h, Vector::Zero(n), dim};
      for (Index i = 0; i < m; ++i) {
        if (i % 3 == 0) continue;
        x[i] = 1.5 + random();
        const Vector direction = random.vector(dim - 1).normalized();
        x.segment(p.tangent(i), dim - 1) = coefficient * x[i] * direction;
        if (i % 2 == 0) w.segment(p.tangent(i), dim - 1) = -(1.5 + random()) * direction;
      }
      p.q = w - h * x;
      const FrictionResult result = expect_solved(p, {coefficient, 0, false});
      EXPECT_LT((result.x - x).norm(), 1e-10 * x.norm());
      EXPECT_LT(result.iterations, 60);
      EXPECT_LE(expect_solved(p, {coefficient, 0, false}, x).iterations, 3);
    }
}

TEST(Friction, DoesNotDependOnUnits) {
  Random random(8);
  for (const int dim : {2, 3})
    for (int k = 0; k < 10; ++k) {
      const Index m = 10, n = dim * m;
      const FrictionProblem p{random_positive(random, n, 0.1), random.vector(n), dim};
      Vector d(n);
      for (Index i = 0; i < m; ++i)
        d[i] = std::pow(10, 6 * random());
      for (Index i = 0; i < m; ++i)
        d.segment(p.tangent(i), dim - 1).setConstant(d[i]);
      const FrictionBound coulomb{0.3, 0, false};
      const FrictionResult plain = expect_solved(p, coulomb);
      const FrictionProblem scaled{d.asDiagonal() * p.h * d.asDiagonal(), d.cwiseProduct(p.q), dim};
      const FrictionResult result = expect_solved(scaled, coulomb);
      EXPECT_EQ(result.states, plain.states);
      EXPECT_EQ(result.iterations, plain.iterations);
      EXPECT_LT((result.x.cwiseProduct(d) - plain.x).norm(), 1e-11 * plain.x.norm());
      const FrictionProblem tiny{1e-200 * p.h, 1e-100 * p.q, dim};
      std::set<Index> given;
      EXPECT_EQ(solve_friction(once(tiny.h, given), tiny.q, dim, coulomb).states, plain.states);
    }
}

/// Nodes in space of which each has one free tangent, as on a plane of symmetry, answer as in the
/// plane; no column of the others is asked for.
TEST(Friction, NodesWithOneFreeTangentAnswerAsInThePlane) {
  Random random(7);
  for (int k = 0; k < 30; ++k)
    for (const FrictionBound &bound : all_bounds) {
      if (bound.only_in_contact) continue;
      const Index nodes = 2 + k % 9;
      const Matrix h = random_positive(random, 2 * nodes, 1e-2);
      const Vector q = random.vector(2 * nodes);
      std::vector<Index> rows; // in space
      for (Index i = 0; i < nodes; ++i)
        rows.push_back(i);
      for (Index i = 0; i < nodes; ++i)
        rows.push_back(nodes + 2 * i);
      Matrix in_space = Matrix::Zero(3 * nodes, 3 * nodes);
      in_space(rows, rows) = h;
      Vector q_in_space = Vector::Zero(3 * nodes);
      q_in_space(rows) = q;
      const ColumnSource columns = [&](const std::vector<Index> &which) {
        for (const Index row : which)
          EXPECT_TRUE(std::ranges::find(rows, row) != rows.end());
        return Matrix(in_space(Eigen::all, which));
      };
      NodeLaws laws = uniform_laws(nodes, 3, bound);
      laws.free.assign(nodes, 1);
      Vector start = Vector::Ones(3 * nodes); // which the laws do not allow
      const FrictionResult plane = solve_friction(
          [&](const std::vector<Index> &which) { return Matrix(h(Eigen::all, which)); }, q,
          uniform_laws(nodes, 2, bound));
      const FrictionResult space = solve_friction(columns, q_in_space, laws, start);
      ASSERT_TRUE(plane.converged && space.converged) << space.reason;
      EXPECT_LE((space.x(rows) - plane.x).norm(), 1e-9 * plane.x.norm());
      Vector across = space.x;
      across(rows).setZero();
      EXPECT_TRUE(across.isZero(0));
    }
}

} // namespace rbvi::friction_test
