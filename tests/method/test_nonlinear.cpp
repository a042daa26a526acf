// Contact that follows the displacement, on beads held by springs: single ones in closed form,
// coupled ones against each other's methods and as minima of the energy.
#include "random_matrix.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/method/anderson.hpp"
#include "rbvi/method/nonlinear.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::nonlinear_test {
namespace {

/// Columns of a dense matrix, those that are required.
class DenseColumns : public Compliance {
public:
  explicit DenseColumns(Matrix c) : Compliance(c.cols()), c_(std::move(c)) {}

private:
  void make(const std::vector<Index> &dofs, Eigen::Ref<Matrix> columns) override {
    columns = c_(Eigen::all, dofs);
  }
  Matrix c_;
};

/// Beads at `at`, two dofs each, outside of the disk of this radius about the origin, or inside.
struct Beads {
  Matrix at; ///< 2 x beads
  Matrix compliance;
  Vector free;
  double radius = 1;
  double side = 1; ///< 1: outside, -1: inside
  FrictionBound bound{};
  bool friction = false;

  Index count() const { return at.cols(); }
  NonlinearContact problem(Compliance &columns) const {
    const Index n = count();
    NonlinearContact contact{
        [this](const Vector &state, Linearised &l) { linearise(state, l); },
        [this](const Vector &state, const Vector &x) { return curvature(state, x); },
        &columns,
        free,
        Vector::Zero(2 * n),
        uniform_laws(n, friction ? 2 : 1, bound),
        SparseMatrix(
            Matrix::Identity(n * (friction ? 2 : 1), n * (friction ? 2 : 1)).sparseView())};
    return contact;
  }
  void linearise(const Vector &state, Linearised &l) const {
    const Index n = count(), rows = friction ? 2 * n : n;
    l.b = SparseMatrix(rows, 2 * n);
    l.g = Vector::Zero(rows);
    for (Index i = 0; i < n; ++i) {
      const Eigen::Vector2d y = at.col(i) + state.segment<2>(2 * i), nu = side * y.normalized();
      l.b.insert(i, 2 * i) = -nu[0];
      l.b.insert(i, 2 * i + 1) = -nu[1];
      l.g[i] = side * (y.norm() - radius) - nu.dot(state.segment<2>(2 * i));
      if (!friction) continue;
      l.b.insert(n + i, 2 * i) = nu[1];
      l.b.insert(n + i, 2 * i + 1) = -nu[0];
    }
    l.b.makeCompressed();
  }
  /// The same without B: at a bead its own displacement, which nothing averages.
  void evaluate(const Vector &state, const Vector &x, NodalCondition &condition) const {
    const Index n = count();
    Linearised l;
    linearise(state, l);
    condition.w = l.g - l.b * state;
    condition.load = l.b.transpose() * x;
    condition.normal.resize(2, n);
    condition.rotation.resize(n);
    for (Index i = 0; i < n; ++i) {
      const Eigen::Vector2d y = at.col(i) + state.segment<2>(2 * i);
      condition.normal.col(i) = -side * y.normalized();
      condition.rotation[i] = side * x[i] / y.norm();
    }
  }
  CurvatureRows curvature(const Vector &state, const Vector &x) const {
    const Index n = count();
    CurvatureRows rows{SparseMatrix(n, 2 * n), SparseMatrix(n, 2 * n)};
    for (Index i = 0; i < n; ++i) {
      const Eigen::Vector2d y = at.col(i) + state.segment<2>(2 * i), nu = y.normalized();
      const double half = side * x[i] / y.norm() / 2;
      rows.s.insert(i, 2 * i) = nu[1];
      rows.s.insert(i, 2 * i + 1) = -nu[0];
      rows.e.insert(i, 2 * i) = half * nu[1];
      rows.e.insert(i, 2 * i + 1) = -half * nu[0];
    }
    return rows;
  }
};

/// A row of coupled beads above the disk, pushed down into it; `skew` moves them sideways.
Beads pushed_row(Index n, double skew) {
  Beads beads;
  beads.at.resize(2, n);
  Matrix stiffness = Matrix::Zero(2 * n, 2 * n);
  for (Index i = 0; i < n; ++i) {
    const double s = 2.0 * static_cast<double>(i) / static_cast<double>(n - 1) - 1;
    beads.at.col(i) << 0.8 * s + skew, 1.05 + 0.3 * s * s;
    for (Index c = 0; c < 2; ++c) {
      stiffness(2 * i + c, 2 * i + c) += c == 0 ? 1 : 2;
      if (i == 0) continue;
      for (const Index a : {2 * i + c, 2 * (i - 1) + c})
        for (const Index b : {2 * i + c, 2 * (i - 1) + c})
          stiffness(a, b) += a == b ? 4 : -4;
    }
  }
  beads.compliance = stiffness.inverse();
  Vector load = Vector::Zero(2 * n);
  for (Index i = 0; i < n; ++i)
    load[2 * i + 1] = -0.5;
  beads.free = beads.compliance * load;
  return beads;
}

/// `average`: what the method `nodal` takes for the displacement of a bead, in parts of it.
NonlinearResult solve(const Beads &beads, NonlinearMethod method, double tolerance = 1e-12,
                      double average = 1, bool economical = false) {
  DenseColumns columns(beads.compliance);
  NonlinearOptions options;
  options.method = method;
  options.tolerance = tolerance;
  options.economical = economical;
  NonlinearContact problem = beads.problem(columns);
  const Index dofs = 2 * beads.count();
  NodalCompliance compliance((average * Matrix::Identity(dofs, dofs)).sparseView());
  const auto evaluate = [&](const Vector &state, const Vector &x, const std::vector<bool> &,
                            NodalCondition &condition) { beads.evaluate(state, x, condition); };
  if (method == NonlinearMethod::nodal) problem.nodal.emplace(NodalContact{evaluate, compliance});
  return solve_nonlinear(problem, {Vector::Zero(dofs), {}}, options);
}

// A bead on an isotropic spring comes to the point of the disk next to where it would be without
// it, with the pressure of the spring; from the side it takes steps to find it.
TEST(Nonlinear, ASingleBeadFindsTheNextPoint) {
  Beads bead;
  bead.at = Matrix{{0.3}, {1.2}};
  bead.compliance = 0.5 * Matrix::Identity(2, 2);
  bead.free = Vector{{0.2, -0.8}};
  const Eigen::Vector2d wanted = bead.at + bead.free;
  for (const NonlinearMethod method : {NonlinearMethod::kacanov, NonlinearMethod::newton,
                                       NonlinearMethod::anderson, NonlinearMethod::nodal}) {
    const NonlinearResult found = solve(bead, method);
    ASSERT_TRUE(found.converged) << found.reason;
    EXPECT_LT((bead.at + found.state - wanted.normalized()).norm(), 1e-11);
    EXPECT_NEAR(found.x[0], 2 * (1 - wanted.norm()), 1e-11);
    EXPECT_EQ(found.active, std::vector<Index>{0});
  }
}

TEST(Nonlinear, AllMethodsFindTheSame) {
  for (const double skew : {0.0, 0.2}) {
    const Beads beads = pushed_row(21, skew);
    const NonlinearResult kacanov = solve(beads, NonlinearMethod::kacanov),
                          newton = solve(beads, NonlinearMethod::newton),
                          anderson = solve(beads, NonlinearMethod::anderson);
    ASSERT_TRUE(kacanov.converged && newton.converged && anderson.converged);
    EXPECT_GT(kacanov.active.size(), 3U);
    EXPECT_LT((newton.state - kacanov.state).norm(), 1e-10 * kacanov.state.norm());
    EXPECT_LT((anderson.state - kacanov.state).norm(), 1e-10 * kacanov.state.norm());
    EXPECT_LT((newton.x - kacanov.x).norm(), 1e-10 * kacanov.x.norm());
    EXPECT_LE(newton.steps, 6);
    EXPECT_LT(newton.steps, kacanov.steps);
    EXPECT_LE(anderson.steps, kacanov.steps);
    EXPECT_EQ(kacanov.iterates.size(), static_cast<std::size_t>(kacanov.steps));
    EXPECT_GT(kacanov.rate, 0.01);
    EXPECT_LT(kacanov.rate, 0.9);
  }
}

// Where nothing is averaged, steps with the tangent between nodes are Newton's; where it is wrong
// by a tenth they contract by that, to the same solution.
TEST(Nonlinear, AWrongTangentBetweenNodesCostsStepsAlone) {
  for (const double skew : {0.0, 0.2})
    for (const bool friction : {false, true}) {
      Beads beads = pushed_row(21, skew);
      beads.friction = friction;
      beads.bound = {0.3, 0, false};
      const NonlinearResult expected = solve(beads, NonlinearMethod::automatic);
      const NonlinearResult right = solve(beads, NonlinearMethod::nodal),
                            economical = solve(beads, NonlinearMethod::nodal, 1e-12, 1, true),
                            wrong = solve(beads, NonlinearMethod::nodal, 1e-12, 0.95);
      for (const NonlinearResult *found : {&right, &economical, &wrong}) {
        ASSERT_TRUE(found->converged) << found->reason;
        EXPECT_LT((found->x - expected.x).norm(), 1e-10 * expected.x.norm());
        EXPECT_LT((found->state - expected.state).norm(), 1e-10 * expected.state.norm());
        EXPECT_LT((found->reaction - expected.reaction).norm(), 1e-10 * expected.reaction.norm());
      }
      EXPECT_LE(right.steps, expected.steps + 1);
      EXPECT_GE(wrong.steps, right.steps + (friction ? 0 : 1));
    }
}

// No admissible bead beside the solution has less energy; to first order it has more.
TEST(Nonlinear, TheSolutionIsAMinimumOfTheEnergy) {
  const Beads beads = pushed_row(11, 0.1);
  const NonlinearResult found = solve(beads, NonlinearMethod::newton);
  ASSERT_TRUE(found.converged);
  const Matrix stiffness = beads.compliance.inverse();
  const auto energy = [&](const Vector &u) {
    const Vector v = u - beads.free;
    return 0.5 * v.dot(stiffness * v);
  };
  Random random(1);
  for (int k = 0; k < 200; ++k) {
    Vector u = found.state + 1e-3 * random.vector(found.state.size());
    for (Index i = 0; i < beads.count(); ++i) { // back out of the disk
      const Eigen::Vector2d y = beads.at.col(i) + u.segment<2>(2 * i);
      if (y.norm() < 1) u.segment<2>(2 * i) = y.normalized() - beads.at.col(i);
    }
    EXPECT_GE(energy(u), energy(found.state));
  }
}

TEST(Nonlinear, AStartNextToTheSolutionSavesSteps) {
  const Beads beads = pushed_row(21, 0.2);
  const NonlinearResult cold = solve(beads, NonlinearMethod::newton);
  DenseColumns columns(beads.compliance);
  const NonlinearResult warm =
      solve_nonlinear(beads.problem(columns), {1.001 * cold.state, cold.x}, {});
  ASSERT_TRUE(warm.converged);
  EXPECT_LE(warm.steps, 3);
  EXPECT_LT((warm.state - cold.state).norm(), 1e-9 * cold.state.norm());
}

TEST(Nonlinear, FrictionHoldsEveryStep) {
  Beads beads = pushed_row(21, 0.2);
  beads.friction = true;
  for (const double coefficient : {0.05, 0.3, 2.0}) {
    beads.bound = {coefficient, 0, false};
    const NonlinearResult found = solve(beads, NonlinearMethod::automatic);
    ASSERT_TRUE(found.converged) << found.reason;
    const Vector pressure = found.x.head(beads.count()), shear = found.x.tail(beads.count());
    EXPECT_LE((shear.cwiseAbs() - coefficient * pressure).maxCoeff(), 1e-12);
    Linearised at;
    beads.linearise(found.state, at);
    const Vector w = at.g - at.b * found.state;
    EXPECT_GE(w.head(beads.count()).minCoeff(), -1e-10);
    EXPECT_LE(std::abs(pressure.dot(w.head(beads.count()))), 1e-10);
    for (Index i = 0; i < beads.count(); ++i)
      if (std::abs(shear[i]) < (1 - 1e-8) * coefficient * pressure[i]) {
        EXPECT_NEAR(w[beads.count() + i], 0, 1e-10) << "it sticks";
      }
  }
}

// Where large steps fail, as those that tear a mesh do, the loads come in parts.
TEST(Nonlinear, LoadStepsCureAStartThatFails) {
  const Beads beads = pushed_row(21, 0.1);
  const NonlinearResult expected = solve(beads, NonlinearMethod::newton);
  ASSERT_TRUE(expected.converged) << expected.reason;
  EXPECT_EQ(expected.load_steps, 0);
  DenseColumns columns(beads.compliance);
  NonlinearContact contact = beads.problem(columns);
  Vector last = Vector::Zero(2 * beads.count());
  const double longest = 0.3 * expected.state.norm();
  contact.linearise = [&](const Vector &state, Linearised &l) {
    const double moved = (state - last).norm();
    last = state;
    if (moved > longest && state.norm() > 0) throw failure("torn");
    beads.linearise(state, l);
  };
  const Start rest{Vector::Zero(2 * beads.count()), {}};
  NonlinearOptions options;
  const NonlinearResult found = solve_nonlinear(contact, rest, options);
  ASSERT_TRUE(found.converged) << found.reason;
  EXPECT_EQ(found.load_steps, 8);
  EXPECT_NE(found.reason.find("8 load steps"), std::string::npos) << found.reason;
  EXPECT_NE(found.reason.find("torn"), std::string::npos) << found.reason;
  EXPECT_LT((found.state - expected.state).norm(), 1e-9 * expected.state.norm());
  options.load_steps = 0;
  last.setZero();
  const NonlinearResult alone = solve_nonlinear(contact, rest, options);
  EXPECT_FALSE(alone.converged);
  EXPECT_EQ(alone.reason, "torn");
}

// The motion of a rigid body is stepped like loads: it is what the undeformed state takes back.
TEST(Nonlinear, LoadStepsOfAMotionEndWhereItEnds) {
  Beads beads = pushed_row(21, 0.1);
  beads.free.setZero();
  for (Index i = 0; i < beads.count(); ++i)
    beads.at(1, i) -= 0.2; // moved
  const NonlinearResult expected = solve(beads, NonlinearMethod::newton);
  ASSERT_TRUE(expected.converged) << expected.reason;
  DenseColumns columns(beads.compliance);
  NonlinearContact contact = beads.problem(columns);
  for (Index i = 0; i < beads.count(); ++i)
    contact.undeformed[2 * i + 1] = 0.2;
  int calls = 0;
  contact.linearise = [&](const Vector &state, Linearised &l) {
    if (++calls == 2) throw failure("the second step fails");
    beads.linearise(state, l);
  };
  const NonlinearResult found = solve_nonlinear(contact, {contact.undeformed, {}}, {});
  ASSERT_TRUE(found.converged) << found.reason;
  EXPECT_EQ(found.load_steps, 8);
  EXPECT_LT((found.state - expected.state).norm(), 1e-9 * expected.state.norm());
}

// A bead in a hollow disk, pressed onto it by a stiff spring and held weakly along it: Kacanov's
// iteration swings from side to side. Newton and Anderson find the state that it misses.
TEST(Nonlinear, AnIterationThatDoesNotContractIsNoAnswer) {
  Beads bead;
  bead.side = -1;
  bead.at = Matrix{{0.1}, {-0.9}};
  bead.compliance = Matrix{{1, 0}, {0, 0.1}};
  bead.free = Vector{{0, -0.3}};
  DenseColumns columns(bead.compliance);
  NonlinearOptions options;
  options.method = NonlinearMethod::kacanov;
  const NonlinearResult swings =
      solve_nonlinear(bead.problem(columns), {Vector::Zero(2), {}}, options);
  EXPECT_FALSE(swings.converged);
  EXPECT_NE(swings.reason.find("-nonlinear_method"), std::string::npos) << swings.reason;
  EXPECT_EQ(swings.x.size(), 0);
  const NonlinearResult newton = solve(bead, NonlinearMethod::newton),
                        anderson = solve(bead, NonlinearMethod::anderson);
  ASSERT_TRUE(newton.converged) << newton.reason;
  ASSERT_TRUE(anderson.converged) << anderson.reason;
  EXPECT_LT((newton.state - anderson.state).norm(), 1e-10);
  EXPECT_NEAR((bead.at + newton.state).norm(), 1, 1e-12);
}

/// The refusal of a method.
std::string refusal(const NonlinearContact &contact, NonlinearMethod method) {
  NonlinearOptions options;
  options.method = method;
  try {
    (void)solve_nonlinear(contact, {contact.undeformed, {}}, options);
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::bad_input);
    return error.what();
  }
  return "";
}

TEST(Nonlinear, AMethodThatContactHasNotIsRefused) {
  Beads beads = pushed_row(5, 0.1);
  DenseColumns columns(beads.compliance);
  NonlinearContact contact = beads.problem(columns);
  EXPECT_EQ(refusal(contact, NonlinearMethod::newton), "");
  EXPECT_NE(refusal(contact, NonlinearMethod::nodal).find("leave it out (newton)"),
            std::string::npos);
  contact.curvature = {};
  EXPECT_NE(refusal(contact, NonlinearMethod::newton).find("-normal rigid"), std::string::npos);
  beads.friction = true;
  const NonlinearContact rough = beads.problem(columns);
  EXPECT_NE(refusal(rough, NonlinearMethod::newton).find("without friction"), std::string::npos);
  EXPECT_EQ(refusal(rough, NonlinearMethod::automatic), "");
}

// Segments that alternate to the end are told, in an answer and in a failure; what settles is not.
TEST(Nonlinear, SegmentsThatDoNotSettleAreReported) {
  const Beads beads = pushed_row(21, 0.2);
  DenseColumns columns(beads.compliance);
  NonlinearContact contact = beads.problem(columns);
  NonlinearOptions options;
  int steps = 0, settled = 2;
  contact.linearise = [&](const Vector &state, Linearised &l) {
    beads.linearise(state, l);
    l.segments = {std::min(steps++, settled) % 2};
  };
  const Start rest{Vector::Zero(2 * beads.count()), {}};
  const NonlinearResult still = solve_nonlinear(contact, rest, options);
  ASSERT_TRUE(still.converged) << still.reason;
  EXPECT_EQ(still.segments_moved, 3);
  EXPECT_EQ(still.reason.find("vertices"), std::string::npos) << still.reason;
  steps = 0;
  settled = 1000;
  const NonlinearResult alternating = solve_nonlinear(contact, rest, options);
  ASSERT_TRUE(alternating.converged) << alternating.reason;
  EXPECT_EQ(alternating.segments_moved, alternating.steps);
  EXPECT_NE(alternating.reason.find("vertices"), std::string::npos) << alternating.reason;
  EXPECT_LT((alternating.x - still.x).norm(), 1e-14 * still.x.norm());
  options.max_steps = 2;
  options.load_steps = 0;
  const NonlinearResult failed = solve_nonlinear(contact, rest, options);
  EXPECT_FALSE(failed.converged);
  EXPECT_NE(failed.reason.find("vertices"), std::string::npos) << failed.reason;
  EXPECT_EQ(failed.last_x.size(), still.x.size());
  EXPECT_EQ(failed.reason.find("newton"), std::string::npos) << "it is Newton's method";
  EXPECT_NE(failed.reason.find("anderson"), std::string::npos) << failed.reason;
}

TEST(Anderson, SolvesALinearFixedPointLikeGmres) {
  Random random(2);
  const Matrix rotation{{0, -1.5}, {1.5, 0}}; // |eigenvalues| 1.5: the plain iteration diverges
  const Vector right = random.vector(2);
  Anderson anderson(5);
  std::vector<Vector> images;
  Vector state = Vector::Zero(2);
  for (int k = 0; k < 4; ++k) {
    images.push_back(rotation * state + right);
    const Vector shares = anderson.combine(images.back() - state);
    EXPECT_NEAR(shares.sum(), 1, 1e-12);
    state.setZero();
    for (Index j = 0; j < shares.size(); ++j)
      state += shares[j] * images[j];
  }
  EXPECT_LT((rotation * state + right - state).norm(), 1e-12);
}

} // namespace
} // namespace rbvi::nonlinear_test
