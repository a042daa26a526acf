#include "../linear_algebra.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/law/friction/least_squares_friction.hpp"

#include "columns.hpp"
#include "half_plane.hpp"
#include "random_matrix.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rbvi::least_squares_friction_test {

namespace {

const std::vector<FrictionBound> all_bounds{
    {0, 0, false}, {0.3, 0, false}, {0, 0.1, false}, {0, 0.01, true}, {0.2, 0.1, false}};

/// All nodes of a half-plane, and gaps that are symmetric about its middle.
struct HalfPlane {
  Index nodes;
  Matrix h = half_plane(nodes);

  /// A round punch: gap = shift + curvature x^2, x in [-1, 1].
  Vector punch(double shift, double curvature) const {
    Vector q = Vector::Zero(2 * nodes);
    for (Index i = 0; i < nodes; ++i) {
      const double x = 2 * static_cast<double>(i) / static_cast<double>(nodes - 1) - 1;
      q[i] = shift + curvature * x * x;
    }
    return q;
  }
};

FrictionResult full(const Matrix &h, const Vector &q, const FrictionBound &bound) {
  return solve_friction(columns_of(h), q, 2, bound);
}

std::vector<int> all_nodes(Index count) {
  std::vector<int> result;
  for (int j = 0; j < count; ++j)
    result.push_back(j);
  return result;
}

LeastSquaresProblem reduced(const Matrix &h, const Vector &q, const Matrix &basis,
                            const std::vector<int> &nodes, const FrictionBound &bound) {
  std::vector<int> shifted = nodes;
  for (int &node : shifted)
    node += static_cast<int>(q.size() / 2);
  const Matrix w = h * basis;
  const Vector diagonal = h.diagonal();
  return {.normal = basis(nodes, Eigen::all),
          .tangential = basis(shifted, Eigen::all),
          .gap_rows = w(nodes, Eigen::all),
          .slip_rows = w(shifted, Eigen::all),
          .gap = q(nodes),
          .slip = q(shifted),
          .gap_scale = diagonal(nodes),
          .slip_scale = diagonal(shifted),
          .bounds = {bound}};
}

std::vector<NodeState> node_states(const LeastSquaresResult &result) {
  std::vector<NodeState> states;
  for (const SlipState &state : result.states)
    states.push_back(state.state);
  return states;
}

/// Punches that touch more and more nodes. Two close ones of every kind: with the same states the
/// solution is linear in (shift, curvature), so the basis holds all that lie between.
struct Family {
  HalfPlane plane{41};
  FrictionBound bound;
  std::vector<Vector> loads, solutions;
  std::vector<std::vector<NodeState>> states;
  Matrix basis;

  explicit Family(const FrictionBound &of) : bound(of) {
    for (int k = 0; k < 20; ++k) {
      const double shift = -0.1 - 0.08 * (k / 2);
      loads.push_back(plane.punch(shift * (1 + 0.002 * (k % 2)), 1));
      const FrictionResult result = full(plane.h, loads.back(), bound);
      EXPECT_TRUE(result.converged) << result.reason;
      solutions.push_back(result.x);
      states.push_back(result.states);
    }
    basis = basis_of_snapshots(20);
  }
  /// Left singular vectors of the first snapshots, down to round-off.
  Matrix basis_of_snapshots(Index count) const {
    Matrix snapshots(82, count);
    for (Index k = 0; k < count; ++k)
      snapshots.col(k) = solutions[static_cast<std::size_t>(k)];
    const ThinSvd svd = thin_svd(snapshots);
    return svd.left.leftCols((svd.values.array() > 1e-12 * svd.values[0]).count());
  }
  std::vector<int> few_nodes() const {
    return pivot_nodes(basis, static_cast<int>(basis.cols()) + 3);
  }
  LeastSquaresProblem problem(const Vector &q, const std::vector<int> &nodes) const {
    return reduced(plane.h, q, basis, nodes, bound);
  }
};

double error(const Vector &x, const Vector &expected) {
  return (x - expected).norm() / expected.norm();
}

} // namespace

TEST(LeastSquaresFriction, WithAllUnitVectorsItIsTheFullProblem) {
  Random random(1);
  for (int k = 0; k < 60; ++k) {
    const Index m = 1 + k % 12, n = 2 * m;
    const Matrix b = random.matrix(n, n), h = b * b.transpose() + 0.1 * Matrix::Identity(n, n);
    const Vector q = random.vector(n);
    for (const FrictionBound &bound : all_bounds) {
      const FrictionResult expected = full(h, q, bound);
      if (!expected.converged) continue;
      const LeastSquaresProblem p = reduced(h, q, Matrix::Identity(n, n), all_nodes(m), bound);
      const LeastSquaresResult result = solve_least_squares(p);
      EXPECT_TRUE(result.converged) << result.reason;
      EXPECT_LT(result.residual, 1e-10);
      if (!bound.only_in_contact) { // which can have several solutions
        EXPECT_LT((result.y - expected.x).norm(), 1e-10 * (1 + expected.x.norm()));
        EXPECT_EQ(node_states(result), expected.states);
      }
      EXPECT_EQ(solve_least_squares(p, result.states).iterations, 1);
    }
  }
}

TEST(LeastSquaresFriction, ReproducesWhatItsBasisHolds) {
  for (const FrictionBound &bound : all_bounds) {
    const Family family(bound);
    for (const std::vector<int> &nodes : {all_nodes(41), family.few_nodes()})
      for (std::size_t k = 0; k < family.loads.size(); ++k) {
        const LeastSquaresResult result =
            solve_least_squares(family.problem(family.loads[k], nodes));
        EXPECT_TRUE(result.converged) << result.reason;
        EXPECT_LT(error(family.basis * result.y, family.solutions[k]), 1e-9);
        EXPECT_LT(result.residual, 1e-9);
        EXPECT_LT(result.iterations, 12);
      }
  }
}

TEST(LeastSquaresFriction, AndWhatLiesBetweenWithTheSameStates) {
  for (const FrictionBound &bound : all_bounds) {
    const Family family(bound);
    int compared = 0;
    for (std::size_t k = 0; k + 1 < family.loads.size(); k += 2) {
      const Vector q = 0.6 * family.loads[k] + 0.4 * family.loads[k + 1];
      const FrictionResult expected = full(family.plane.h, q, bound);
      ASSERT_TRUE(expected.converged);
      if (expected.states != family.states[k] || expected.states != family.states[k + 1]) continue;
      ++compared;
      for (const std::vector<int> &nodes : {all_nodes(41), family.few_nodes()}) {
        const LeastSquaresResult result = solve_least_squares(family.problem(q, nodes));
        EXPECT_TRUE(result.converged) << result.reason;
        EXPECT_LT(error(family.basis * result.y, expected.x), 1e-8);
      }
    }
    EXPECT_GE(compared, 5);
  }
}

TEST(LeastSquaresFriction, TheResidualIsSmallIfAndOnlyIfTheBasisHoldsTheSolution) {
  int held = 0, missed = 0;
  for (const FrictionBound &bound : all_bounds) {
    Family family(bound);
    family.basis = family.basis_of_snapshots(6);
    for (std::size_t k = 0; k < family.loads.size(); ++k) {
      const Matrix &u = family.basis;
      const Vector &x = family.solutions[k];
      const bool holds = error(u * (u.transpose() * x), x) < 1e-9;
      (holds ? held : missed) += 1;
      const LeastSquaresResult result =
          solve_least_squares(family.problem(family.loads[k], all_nodes(41)));
      EXPECT_EQ(result.residual < 1e-8, holds) << result.residual;
      EXPECT_GE(result.residual, holds ? 0 : 1e-2 * error(u * (u.transpose() * x), x));
    }
  }
  EXPECT_GT(held, 20);
  EXPECT_GT(missed, 20);
}

TEST(LeastSquaresFriction, AWarmStartGivesTheSameInOneStep) {
  for (const FrictionBound &bound : all_bounds) {
    const Family family(bound);
    std::vector<SlipState> before;
    for (const Vector &q : family.loads) {
      const LeastSquaresProblem p = family.problem(q, family.few_nodes());
      const LeastSquaresResult cold = solve_least_squares(p);
      const LeastSquaresResult warm = solve_least_squares(p, before);
      EXPECT_TRUE(warm.converged);
      EXPECT_EQ(warm.states, cold.states);
      EXPECT_LT(error(warm.y, cold.y), 1e-10);
      const LeastSquaresResult again = solve_least_squares(p, cold.states);
      EXPECT_EQ(again.iterations, 1);
      EXPECT_EQ(again.y, cold.y);
      before = cold.states;
    }
  }
}

TEST(LeastSquaresFriction, OneNodeByHand) {
  // As in test_friction.cpp: x_n = 2; without a bound x_tau would be -1.
  const Matrix h = Matrix::Identity(2, 2);
  const auto solve = [&](const Vector &q, const FrictionBound &bound) {
    return solve_least_squares(reduced(h, q, h, {0}, bound));
  };
  const Vector pressed{{-2, 1}}, apart{{1, 1}};
  const LeastSquaresResult slip = solve(pressed, {0.25, 0, false});
  EXPECT_LT((slip.y - Vector{{2, -0.5}}).norm(), 1e-15);
  EXPECT_EQ(slip.states[0], (SlipState{NodeState::slip, -1}));
  EXPECT_EQ(solve(pressed, {1, 0, false}).states[0], (SlipState{NodeState::stick, 0}));
  // Without a bound nothing holds a node that touches: it slips, and x_tau = 0.
  EXPECT_EQ(solve(pressed, {}).states[0], (SlipState{NodeState::slip, 0}));
  EXPECT_EQ(solve(apart, {0.25, 0, false}).states[0], SlipState{});
  // Tresca's threshold acts across the gap: open nodes can stick (direction 0) or slip.
  const LeastSquaresResult held = solve(apart, {0, 2, false}),
                           pulled = solve(apart, {0, 0.5, false});
  EXPECT_EQ(held.states[0], SlipState{});
  EXPECT_LT((held.y - Vector{{0, -1}}).norm(), 1e-15);
  EXPECT_EQ(pulled.states[0], (SlipState{NodeState::open, -1}));
  EXPECT_LT((pulled.y - Vector{{0, -0.5}}).norm(), 1e-15);
  EXPECT_EQ(solve(apart, {0, 2, true}).y, Vector::Zero(2));
}

TEST(LeastSquaresFriction, DoesNotDependOnUnits) {
  Random random(2);
  const Family family({0.3, 0, false});
  const Vector q = family.loads[9];
  const LeastSquaresResult plain = solve_least_squares(family.problem(q, all_nodes(41)));
  const Vector node = Vector::NullaryExpr(41, [&](Index) { return std::pow(10, 4 * random()); });
  Vector d(82);
  d << node, node;
  const Matrix h = d.asDiagonal() * family.plane.h * d.asDiagonal();
  const Matrix basis = d.cwiseInverse().asDiagonal() * family.basis;
  for (const double unit : {1.0, 1e-100, 1e100}) {
    const LeastSquaresProblem p =
        reduced(unit * h, unit * d.cwiseProduct(q), basis, all_nodes(41), family.bound);
    const LeastSquaresResult result = solve_least_squares(p);
    EXPECT_EQ(result.states, plain.states);
    EXPECT_EQ(result.iterations, plain.iterations);
    EXPECT_LT(error(result.y, plain.y), 1e-10);
  }
}

TEST(LeastSquaresFriction, ModesThatTheEquationsDoNotDetermine) {
  const Family family({0.3, 0, false});
  const Vector q = family.loads[6];
  // Every mode twice: halves.
  Matrix twice(82, 2 * family.basis.cols());
  twice << family.basis, family.basis;
  const LeastSquaresResult result =
      solve_least_squares(reduced(family.plane.h, q, twice, all_nodes(41), family.bound));
  EXPECT_TRUE(result.converged);
  EXPECT_NE(result.reason.find("do not determine all modes"), std::string::npos);
  EXPECT_LT(error(twice * result.y, family.solutions[6]), 1e-9);
  EXPECT_LT(error(result.y.head(family.basis.cols()), result.y.tail(family.basis.cols())), 1e-9);
}

TEST(LeastSquaresFriction, SaysWhenStatesAlternate) {
  // Where the bound jumps at the first pressure, a problem need not have a solution.
  Random random(3);
  int without_solution = 0;
  for (int k = 0; k < 200; ++k) {
    const Index m = 1 + k % 3, n = 2 * m;
    const Matrix b = random.matrix(n, n), h = b * b.transpose() + 1e-2 * Matrix::Identity(n, n);
    const Vector q = random.vector(n);
    const FrictionBound jump{0, 0.2, true};
    const LeastSquaresResult result =
        solve_least_squares(reduced(h, q, Matrix::Identity(n, n), all_nodes(m), jump));
    EXPECT_TRUE(!result.converged || full(h, q, jump).converged);
    if (result.converged) continue;
    ++without_solution;
    EXPECT_GT(result.residual, 1e-6);
    EXPECT_NE(result.reason.find("alternate"), std::string::npos);
    EXPECT_NE(result.reason.find("add modes"), std::string::npos);
  }
  EXPECT_GT(without_solution, 5);
}

TEST(LeastSquaresFriction, EndsForBasesThatHoldNothing) {
  Random random(4);
  int alternate = 0;
  for (int k = 0; k < 100; ++k) {
    const Index m = 8, n = 2 * m;
    const Matrix b = random.matrix(n, n), h = b * b.transpose() + 0.1 * Matrix::Identity(n, n);
    const Matrix basis = random.matrix(n, 4 + k % 12);
    for (const FrictionBound &bound : all_bounds) {
      const LeastSquaresResult result =
          solve_least_squares(reduced(h, random.vector(n), basis, all_nodes(m), bound));
      EXPECT_TRUE(result.y.allFinite());
      EXPECT_LE(result.iterations, 82);
      const bool settled = result.reason.starts_with("the states have settled");
      EXPECT_EQ(result.reason.find("add modes") != std::string::npos, result.residual > 0.1);
      EXPECT_EQ(result.converged, settled || result.residual <= 0.1) << result.reason;
      alternate += !settled;
    }
  }
  EXPECT_GT(alternate, 10);
}

/// Nodes of interfaces that have laws of their own, some of them without friction.
TEST(LeastSquaresFriction, EveryNodeHasABoundOfItsOwn) {
  Random random(12);
  int compared = 0;
  for (int k = 0; k < 40; ++k) {
    const Index m = 2 + k % 8, n = 2 * m;
    const Matrix b = random.matrix(n, n), h = b * b.transpose() + 0.5 * Matrix::Identity(n, n);
    const Vector q = random.vector(n);
    NodeLaws laws = uniform_laws(m, 2, {});
    for (Index i = 0; i < m; ++i)
      laws.bound[static_cast<std::size_t>(i)] = {i % 3 == 0 ? 0.0 : 0.2, i % 3 == 2 ? 0.1 : 0.0,
                                                 false};
    const FrictionResult expected = solve_friction(columns_of(h), q, laws);
    if (!expected.converged) continue;
    LeastSquaresProblem p = reduced(h, q, Matrix::Identity(n, n), all_nodes(m), {});
    p.bounds = laws.bound;
    const LeastSquaresResult result = solve_least_squares(p);
    EXPECT_TRUE(result.converged) << result.reason;
    EXPECT_LT((result.y - expected.x).norm(), 1e-10 * (1 + expected.x.norm()));
    ++compared;
  }
  EXPECT_GT(compared, 30);
}

TEST(LeastSquaresFriction, RefusesBadInput) {
  const Matrix h = half_plane(5);
  const LeastSquaresProblem good =
      reduced(h, Vector::Ones(10), Matrix::Identity(10, 3), all_nodes(5), {0.3, 0, false});
  EXPECT_TRUE(solve_least_squares(good).converged);
  EXPECT_TRUE(solve_least_squares({}).converged);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto status = [&](const auto &spoil, std::size_t started = 0) {
    LeastSquaresProblem p = good;
    spoil(p);
    try {
      solve_least_squares(p, std::vector<SlipState>(started));
    } catch (const Error &problem) {
      return problem.status();
    }
    return Status::done;
  };
  using P = LeastSquaresProblem;
  EXPECT_EQ(status([](P &) {}, 5), Status::done);
  EXPECT_EQ(status([](P &) {}, 4), Status::failed);
  EXPECT_EQ(status([](P &p) { p.tangential.resize(5, 2); }), Status::failed);
  EXPECT_EQ(status([](P &p) { p.slip_rows.resize(4, 3); }), Status::failed);
  EXPECT_EQ(status([](P &p) { p.slip.resize(4); }), Status::failed);
  EXPECT_EQ(status([&](P &p) { p.normal(1, 1) = nan; }), Status::failed);
  EXPECT_EQ(status([&](P &p) { p.gap[1] = nan; }), Status::failed);
  EXPECT_EQ(status([](P &p) { p.gap_scale[1] = 0; }), Status::failed);
  EXPECT_EQ(status([](P &p) { p.bounds.front().coefficient = -1; }), Status::bad_input);
  EXPECT_EQ(status([&](P &p) { p.bounds.front().threshold = nan; }), Status::bad_input);
  EXPECT_EQ(status([](P &p) { p.bounds.resize(3); }), Status::failed);
  // Two equations for three modes.
  EXPECT_EQ(status([&](P &p) {
              p = reduced(h, Vector::Ones(10), Matrix::Identity(10, 3), {2}, p.bounds.front());
            }),
            Status::failed);
}

} // namespace rbvi::least_squares_friction_test
