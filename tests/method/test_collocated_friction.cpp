#include "../linear_algebra.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/method/nonnegative_qp.hpp"
#include "rbvi/method/published/collocated_friction.hpp"

#include "columns.hpp"
#include "half_plane.hpp"
#include "random_matrix.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rbvi::collocated_friction_test {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

const FrictionBound &bound_at(const CollocatedProblem &p, Index node) {
  return p.bounds.size() == 1 ? p.bounds.front() : p.bounds[node];
}

Vector bounds_of(const CollocatedProblem &p, const Vector &x) {
  const Vector pressure = p.normal_rows * x.head(p.normal_rows.cols());
  return Vector::NullaryExpr(pressure.size(), [&](Index j) {
    const FrictionBound &bound = bound_at(p, j);
    const bool held = pressure[j] > 0 || !bound.only_in_contact;
    return std::min(bound.coefficient * pressure[j] + (held ? bound.threshold : 0), bound.limit);
  });
}

/// Where all terms are zero nothing is violated.
double relative(double value, double scale) {
  return value == 0 ? 0 : value / scale;
}

/// The definition, without the multipliers of the solver. The variational inequality says that
/// -w_tau is in the cone of the normals of the bounds that are reached: its distance from it.
double violation(const CollocatedProblem &p, const Vector &x) {
  const Index r = p.normal_rows.cols(), s = p.tangential_rows.cols();
  const Vector w = p.h * x + p.q, terms = p.h.cwiseAbs() * x.cwiseAbs() + p.q.cwiseAbs();
  const Vector root = p.h.diagonal().cwiseSqrt();
  const double largest = root.cwiseProduct(x).cwiseAbs().maxCoeff();
  double worst = 0;
  for (Index i = 0; i < r; ++i) {
    if (x[i] < 0) return infinity;
    worst = larger(worst, relative(-w[i], terms[i]));
    worst = larger(worst,
                   std::min(relative(x[i] * root[i], largest), relative(std::abs(w[i]), terms[i])));
  }
  const Vector bounds = bounds_of(p, x), traction = p.tangential_rows * x.tail(s);
  const Matrix unit = p.tangential_rows * root.tail(s).cwiseInverse().asDiagonal();
  const double size = p.tangential_rows.rows() > 0 ? unit.rowwise().norm().maxCoeff() : 0;
  Matrix normals(s, 0);
  for (Index j = 0; j < bounds.size(); ++j) {
    const double scale = std::max(bounds[j], largest * size);
    worst = larger(worst, relative(std::abs(traction[j]) - bounds[j], scale));
    for (const double side : {-1.0, 1.0}) {
      if (s == 0 || side * traction[j] < bounds[j] - 1e-11 * scale) continue;
      normals.conservativeResize(Eigen::NoChange, normals.cols() + 1);
      normals.rightCols(1) = side * unit.row(j).transpose();
    }
  }
  if (s == 0) return worst;
  const Vector load = -w.tail(s).cwiseQuotient(root.tail(s));
  NonnegativeQp cone(s);
  EXPECT_TRUE(cone.solve(normals, load).converged);
  const double size_of_load = terms.tail(s).cwiseQuotient(root.tail(s)).norm();
  return larger(worst, relative(cone.residual().norm(), size_of_load));
}

CollocatedResult expect_solved(const CollocatedProblem &p, const Vector &start = {}) {
  CollocatedResult result = solve_collocated(p, start);
  EXPECT_TRUE(result.converged) << result.reason;
  EXPECT_LE(result.residual, 1e-12);
  EXPECT_LT(violation(p, result.x), 2e-12);
  EXPECT_LE((result.w - (p.h * result.x + p.q)).norm(), 1e-13 * p.q.norm());
  return result;
}

const std::vector<FrictionBound> all_bounds{{0, 0, false},    {0.2, 0, false},   {0.5, 0, false},
                                            {0, 0.2, false},  {0.2, 0.1, false}, {0.2, 1e-3, true},
                                            {1e-3, 10, false}};

/// Generators and modes couple weakly, so that there is one solution.
CollocatedProblem random_problem(Random &random, Index generators, Index modes, Index nodes) {
  const Index n = generators + modes;
  Matrix h = 0.1 * random.matrix(n, n);
  h = Matrix(h * h.transpose()) + Matrix::Identity(n, n);
  h.topRightCorner(generators, modes) *= 0.5;
  h.bottomLeftCorner(modes, generators) *= 0.5;
  return {h,
          random.vector(n),
          random.matrix(nodes, generators).cwiseMax(0),
          random.matrix(nodes, modes),
          {FrictionBound{}}};
}

/// A round punch on a half-plane of m nodes, pushed along it.
CollocatedProblem punch(Index m, double radius, double slide, double coupling = 0.2) {
  const double size = static_cast<double>(m);
  CollocatedProblem p{half_plane(m, 2, coupling),
                      Vector(2 * m),
                      Matrix::Identity(m, m),
                      Matrix::Identity(m, m),
                      {FrictionBound{}}};
  for (Index i = 0; i < m; ++i) {
    const double u = (static_cast<double>(i) - 0.45 * size) / radius;
    p.q[i] = u * u - 1;
    p.q[m + i] = slide + 0.2 * std::sin(u);
  }
  return p;
}

/// All sets of generators and of bounds that are reached: the solutions of tiny problems.
std::vector<Vector> brute_force(const CollocatedProblem &p) {
  const Index r = p.normal_rows.cols(), s = p.tangential_rows.cols(), m = p.normal_rows.rows();
  std::vector<Vector> found;
  const auto sets = static_cast<Index>(std::pow(2, r) * std::pow(3, m) + 0.5);
  for (Index set = 0; set < sets; ++set) {
    Matrix system = Matrix::Zero(r + s + m, r + s + m);
    Vector right = Vector::Zero(r + s + m);
    system.topLeftCorner(r + s, r + s) = p.h;
    right.head(r + s) = -p.q;
    Index code = set;
    for (Index i = 0; i < r; ++i, code /= 2)
      if (code % 2 == 0) {
        system.row(i) = Vector::Unit(r + s + m, i).transpose();
        right[i] = 0;
      }
    for (Index j = 0; j < m; ++j, code /= 3) {
      const double side = static_cast<double>(code % 3) - 1;
      system.block(r, r + s + j, s, 1) = p.tangential_rows.row(j).transpose();
      if (side == 0) {
        system(r + s + j, r + s + j) = 1;
        continue;
      }
      system.row(r + s + j) << -side * bound_at(p, j).coefficient * p.normal_rows.row(j),
          p.tangential_rows.row(j), Vector::Zero(m).transpose();
      right[r + s + j] = side * bound_at(p, j).threshold;
    }
    Vector x = system.completeOrthogonalDecomposition().solve(right).head(r + s);
    for (Index i = 0; i < r; ++i)
      if ((set >> i & 1) == 0) x[i] = 0;
    if (violation(p, x) < 1e-11) found.push_back(x);
  }
  return found;
}

double distance(const Vector &a, const Vector &b) {
  return (a - b).norm() / b.norm();
}

} // namespace

TEST(CollocatedFriction, LawsHoldForRandomProblems) {
  Random random(1);
  for (int k = 0; k < 200; ++k) {
    CollocatedProblem p = random_problem(random, 1 + k % 9, 1 + (k / 3) % 7, k % 12);
    for (const FrictionBound &bound : all_bounds) {
      p.bounds = {bound};
      // Where the bound jumps at the first pressure, a problem need not have a solution.
      if (!bound.only_in_contact) expect_solved(p);
    }
  }
}

TEST(CollocatedFriction, ABoundMayHaveALimit) {
  Random random(17);
  for (int k = 0; k < 200; ++k) {
    CollocatedProblem p = random_problem(random, 1 + k % 9, 1 + (k / 3) % 7, k % 12);
    p.bounds = {{0.3, 0, false}};
    const Vector coulomb = expect_solved(p).x;
    const Vector bounds = bounds_of(p, coulomb);
    const double highest = bounds.size() > 0 ? bounds.maxCoeff() : 0;
    p.bounds = {{0.3, 0, false, 2 * highest + 1}};
    EXPECT_EQ(expect_solved(p).x, coulomb);
    for (const double part : {0.9, 0.5, 0.01, 0.0}) {
      p.bounds = {{0.3, 0, false, part * highest}};
      expect_solved(p);
    }
  }
}

TEST(CollocatedFriction, IsTheOneThatTryingAllSetsFinds) {
  Random random(2);
  for (int k = 0; k < 20; ++k) {
    CollocatedProblem p = random_problem(random, 3, 1 + k % 3, 3);
    for (const FrictionBound &bound : all_bounds) {
      p.bounds = {bound};
      if (bound.only_in_contact || bound.threshold == 0) continue;
      const std::vector<Vector> found = brute_force(p);
      ASSERT_FALSE(found.empty());
      const Vector x = expect_solved(p).x;
      for (const Vector &other : found)
        EXPECT_LT(distance(x, other), 1e-10);
    }
  }
}

/// Nodes of interfaces that have laws of their own.
TEST(CollocatedFriction, EveryNodeHasABoundOfItsOwn) {
  Random random(11);
  for (int k = 0; k < 20; ++k) {
    CollocatedProblem p = random_problem(random, 3, 1 + k % 3, 3);
    p.bounds = {{0.2, 0.1, false}, {0, 0.3, false}, {0.4, 0.02 * k, false}};
    const Vector x = expect_solved(p).x;
    for (const Vector &other : brute_force(p))
      EXPECT_LT(distance(x, other), 1e-10);
    p.bounds.assign(3, {0.2, 0.1, false});
    const Vector alike = expect_solved(p).x;
    p.bounds.resize(1);
    EXPECT_EQ(alike, expect_solved(p).x);
  }
}

TEST(CollocatedFriction, NodalBasesGiveTheFullProblem) {
  for (const double slide : {0.0, 0.1, 0.6})
    for (const double radius : {3.0, 8.0, 14.0})
      for (const FrictionBound &bound : all_bounds) {
        if (bound.coefficient == 0 && bound.threshold == 0) continue;
        CollocatedProblem p = punch(40, radius, slide);
        p.bounds = {bound};
        const FrictionResult full = solve_friction(columns_of(p.h), p.q, 2, bound);
        ASSERT_TRUE(full.converged) << full.reason;
        EXPECT_LT(distance(expect_solved(p).x, full.x), 1e-10);
      }
}

TEST(CollocatedFriction, WithoutNodesTheTractionIsFree) {
  Random random(3);
  CollocatedProblem p = random_problem(random, 4, 3, 0);
  p.bounds = {{0.3, 0, false}};
  const CollocatedResult result = expect_solved(p);
  EXPECT_LT(result.w.tail(3).norm(), 1e-13 * p.q.norm());
}

TEST(CollocatedFriction, ZeroBoundsLeaveTheKernelOfTheRows) {
  Random random(4);
  CollocatedProblem p = random_problem(random, 4, 5, 2);
  const Vector b = expect_solved(p).x.tail(5);
  EXPECT_LT((p.tangential_rows * b).norm(), 1e-13);
  EXPECT_GT(b.norm(), 0.1);
  p = random_problem(random, 4, 5, 9);
  EXPECT_LT(expect_solved(p).x.tail(5).norm(), 1e-13);
}

TEST(CollocatedFriction, GeneratorsOrModesAlone) {
  Random random(5);
  for (const FrictionBound &bound : all_bounds) {
    CollocatedProblem p = random_problem(random, 4, 0, 3);
    p.bounds = {bound};
    expect_solved(p);
    p = random_problem(random, 0, 4, 6);
    p.bounds = {bound};
    expect_solved(p);
  }
}

TEST(CollocatedFriction, MoreBoundsThanModes) {
  Random random(6);
  for (int k = 0; k < 40; ++k) {
    CollocatedProblem p = random_problem(random, 5, 3, 6);
    p.bounds = {{0.3, k % 2 == 0 ? 0.0 : 0.05, false}};
    CollocatedProblem twice = p;
    twice.normal_rows = p.normal_rows.replicate(3, 1);
    twice.tangential_rows = p.tangential_rows.replicate(3, 1);
    twice.tangential_rows.bottomRows(6) *= -1;
    EXPECT_LT(distance(expect_solved(twice).x, expect_solved(p).x), 1e-11);
  }
}

TEST(CollocatedFriction, ModesThatVanishAtANodeAreNotHeldThere) {
  Random random(7);
  CollocatedProblem p = random_problem(random, 4, 3, 5);
  p.bounds = {{0.3, 0, false}};
  const Vector x = expect_solved(p).x;
  p.normal_rows.conservativeResize(7, Eigen::NoChange);
  p.tangential_rows.conservativeResize(7, Eigen::NoChange);
  p.normal_rows.bottomRows(2).setZero();
  p.tangential_rows.bottomRows(2) = 1e-15 * random.matrix(2, 3);
  EXPECT_LT(distance(expect_solved(p).x, x), 1e-13);
}

TEST(CollocatedFriction, WarmIsColdAndFaster) {
  int cold = 0, warm = 0;
  Vector last;
  for (int k = 0; k < 60; ++k) {
    CollocatedProblem p = punch(30, 4 + 0.1 * k, 0.3);
    p.bounds = {{0.3, 0, false}};
    const CollocatedResult first = expect_solved(p), second = expect_solved(p, last);
    EXPECT_LT(distance(second.x, first.x), 1e-10);
    EXPECT_LE(expect_solved(p, first.x).iterations, 1);
    cold += first.iterations;
    warm += second.iterations;
    last = second.x;
  }
  EXPECT_LE(cold, 2 * 60);
  EXPECT_LE(warm, 2 * 60);
}

TEST(CollocatedFriction, SteepDependenceOnTheBoundsAtTheEdgeOfContact) {
  // Strong coupling, and more nodes around the contact than the modes can follow: the tractions
  // there change far more than the bounds do, and sweeps alone would jump back and forth.
  const Index m = 61, generators = 12, modes = 10;
  Matrix pressures(m, generators), tractions(m, generators);
  const FrictionBound bound{0.2, 0, false};
  for (Index k = 0; k < generators; ++k) {
    const CollocatedProblem p = punch(m, 4 + 2 * static_cast<double>(k), 0.3, 0.8);
    const FrictionResult truth = solve_friction(columns_of(p.h), p.q, 2, bound);
    ASSERT_TRUE(truth.converged) << truth.reason;
    pressures.col(k) = truth.x.head(m);
    tractions.col(k) = truth.x.tail(m);
  }
  Matrix basis = Matrix::Zero(2 * m, generators + modes);
  basis.topLeftCorner(m, generators) = pressures;
  basis.bottomRightCorner(m, modes) = thin_svd(tractions).left.leftCols(modes);
  for (double radius = 4.3; radius < 26; radius += 0.4) {
    const CollocatedProblem full = punch(m, radius, 0.3, 0.8);
    const CollocatedProblem p{basis.transpose() * full.h * basis,
                              basis.transpose() * full.q,
                              basis.topLeftCorner(m, generators),
                              basis.bottomRightCorner(m, modes),
                              {bound}};
    EXPECT_LT(expect_solved(p).iterations, 40) << radius;
  }
}

TEST(CollocatedFriction, DoesNotDependOnUnits) {
  Random random(8);
  for (int k = 0; k < 20; ++k) {
    CollocatedProblem p = random_problem(random, 5, 4, 7);
    p.bounds = {{0.3, 0.05, false}};
    const Vector x = expect_solved(p).x;
    const Vector unit = random.vector(9).unaryExpr([](double v) { return std::pow(10, 6 * v); });
    CollocatedProblem other{1e9 * unit.asDiagonal() * p.h * unit.asDiagonal(),
                            1e9 * 1e-4 * unit.cwiseProduct(p.q),
                            p.normal_rows * unit.head(5).asDiagonal(),
                            p.tangential_rows * unit.tail(4).asDiagonal(),
                            {{0.3, 0.05 * 1e-4, false}}};
    EXPECT_LT(distance(1e4 * unit.cwiseProduct(expect_solved(other).x), x), 1e-10);
  }
}

TEST(CollocatedFriction, ThresholdsInContactOnly) {
  // Two generators on a node each: the first stays apart and carries no traction, the second does.
  CollocatedProblem p{Matrix::Identity(4, 4),
                      Vector{{1, -1, -3, -3}},
                      Matrix::Identity(2, 2),
                      Matrix::Identity(2, 2),
                      {{0.5, 1, true}}};
  EXPECT_LT((expect_solved(p).x - Vector{{0, 1, 0, 1.5}}).norm(), 1e-14);
  p.bounds.front().only_in_contact = false;
  EXPECT_LT((expect_solved(p).x - Vector{{0, 1, 1, 1.5}}).norm(), 1e-14);
}

TEST(CollocatedFriction, SaysWhatIsWrongWithTheInput) {
  Random random(9);
  const CollocatedProblem good = random_problem(random, 3, 2, 4);
  EXPECT_THROW(solve_collocated(good, Vector::Ones(4)), Error);
  CollocatedProblem bad = good;
  bad.normal_rows = good.normal_rows.topRows(3);
  EXPECT_THROW(solve_collocated(bad), Error);
  bad = good;
  bad.q[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(solve_collocated(bad), Error);
  bad = good;
  bad.normal_rows(1, 1) = -0.1;
  EXPECT_THROW(solve_collocated(bad), Error);
  bad = good;
  bad.h.col(1) = bad.h.col(0);
  bad.h.row(1) = bad.h.row(0);
  EXPECT_THROW(solve_collocated(bad), Error);
  bad = good;
  bad.bounds = std::vector<FrictionBound>(3);
  EXPECT_THROW(solve_collocated(bad), Error);
  bad = good;
  bad.bounds.front().threshold = -1;
  try {
    solve_collocated(bad);
    FAIL();
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::bad_input);
  }
}

} // namespace rbvi::collocated_friction_test
