// Whether other answers are seen of a body that contact alone holds, whose threshold of friction
// acts in contact alone: against all answers, by enumeration.
#include "columns.hpp"
#include "random_matrix.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/method/balance.hpp"
#include "rbvi/method/several_answers.hpp"

#include <cmath>
#include <optional>

namespace rbvi::several_free_test {
namespace {

constexpr Index nodes = 3, rows = 2 * nodes;

/// A foot on nodes at x = 0, 1, 2 of a floor: w = H x + gap - D r, D^T x = load, r its motion along
/// x, along y and about the origin.
struct Foot {
  Matrix h, d = Matrix::Zero(rows, 3);
  Vector gap, load = Vector::Zero(3);
  double threshold;

  explicit Foot(unsigned seed) {
    Random random(seed);
    const double soft = std::pow(10.0, static_cast<double>(seed % 3) - 2);
    const Matrix root = random.matrix(rows, rows);
    h = soft * (root * root.transpose() / double(rows) + 0.1 * Matrix::Identity(rows, rows));
    for (Index i = 0; i < nodes; ++i) {
      d.row(i) << 0, -1, -double(i);
      d.row(nodes + i) << 1, 0, 0;
    }
    d /= 3;
    gap = 0.3 * soft * random.vector(rows);
    gap.tail(nodes).setZero();
    const Vector of_load = random.vector(4);
    const double down = 1 + std::abs(of_load[0]);
    load << 0.5 * of_load[1] * down, -down, -down * (1 + 0.8 * of_load[2]);
    load /= 3;
    threshold = 0.1 + 0.6 * std::abs(of_load[3]);
  }
};

/// x of a node each in a state (0 open, 1 stick, 2 and 3 slip, to either side), if it has them.
std::optional<Vector> answer_of(const Foot &foot, const std::vector<int> &states) {
  constexpr double round_off = 1e-9;
  Matrix a = Matrix::Zero(rows + 3, rows + 3);
  Vector right = Vector::Zero(rows + 3);
  for (Index row = 0; row < rows; ++row) {
    const int state = states[row % nodes];
    if (row < nodes ? state > 0 : state == 1) {
      a.row(row) << foot.h.row(row), -foot.d.row(row);
      right[row] = -foot.gap[row];
    } else {
      a(row, row) = 1;
      if (row >= nodes && state > 1) right[row] = state == 2 ? foot.threshold : -foot.threshold;
    }
  }
  a.bottomLeftCorner(3, rows) = foot.d.transpose();
  right.tail(3) = foot.load;
  const Eigen::FullPivLU<Matrix> lu(a);
  if (!lu.isInvertible()) return std::nullopt;
  const Vector y = lu.solve(right), x = y.head(rows),
               w = foot.h * x + foot.gap - foot.d * y.tail(3);
  for (Index i = 0; i < nodes; ++i) {
    const double shear = x[nodes + i];
    const bool fits = states[i] == 0   ? w[i] >= -round_off
                      : states[i] == 1 ? std::abs(shear) <= foot.threshold + round_off
                                       : shear * w[nodes + i] <= round_off;
    if (!fits || (states[i] > 0 && x[i] <= round_off)) return std::nullopt;
  }
  return x;
}

std::vector<Vector> all_answers(const Foot &foot) {
  std::vector<Vector> all;
  for (int number = 0; number < 64; ++number)
    if (const auto x = answer_of(foot, {number % 4, number / 4 % 4, number / 16}))
      if (std::ranges::none_of(all, [&](const Vector &y) { return (y - *x).norm() < 1e-6; }))
        all.push_back(*x);
  return all;
}

/// The answer at which forces balance, as solvers find it, and whether others are seen: by the
/// springs that found it, and by softer ones.
struct Seen {
  Vector x;
  double by_springs = 0, by_softer = 0;
};

std::optional<Seen> seen(const Foot &foot) {
  const NodeLaws laws =
      uniform_laws(nodes, 2, {.threshold = foot.threshold, .only_in_contact = true});
  const Matrix h = foot.h + foot.d * foot.d.transpose();
  const FreeMotions motions{laws, foot.d, foot.load, foot.load.cwiseAbs()};
  FrictionSolver solver(columns_of(h), laws);
  FrictionAnswer answer;
  Vector q;
  const auto solve = [&](const Vector &beta) {
    q = foot.gap - foot.d * (beta + foot.load);
    answer = solver.answer(q, answer.start, answer.start.size() == 0);
    if (!answer.converged) throw failure(answer.reason);
    return HeldAnswer{&motions, &answer.x, beta + foot.load - foot.d.transpose() * answer.x};
  };
  try {
    balance_bodies(Vector::Zero(3), {.solve = solve,
                                     .describe = [](const Matrix &) { return std::string(); },
                                     .lengths = Matrix::Identity(3, 3),
                                     .stiffness = 1,
                                     .advice = ""});
  } catch (const Error &) {
    return std::nullopt;
  }
  return Seen{answer.x, distance_seen(solver, answer, true),
              distance_seen_from(columns_of(h), q, laws, answer, foot.d)};
}

TEST(SeveralFree, OthersAreSeenWhereSpringsAreSoft) {
  int alone = 0, several = 0, false_by_springs = 0, false_by_softer = 0, by_springs = 0,
      by_softer = 0;
  for (unsigned seed = 1; seed <= 2000; ++seed) {
    const Foot foot(seed);
    const std::optional<Seen> found = seen(foot);
    if (!found) continue;
    const std::vector<Vector> all = all_answers(foot);
    ASSERT_FALSE(all.empty());
    EXPECT_TRUE(std::ranges::any_of(
        all, [&](const Vector &x) { return (x - found->x).norm() < 1e-6 * (1 + x.norm()); }));
    const bool is_alone = all.size() == 1;
    ++(is_alone ? alone : several);
    (is_alone ? false_by_springs : by_springs) += found->by_springs > 0;
    (is_alone ? false_by_softer : by_softer) += found->by_softer > 0;
  }
  RecordProperty("several", several);
  EXPECT_GT(several, 20);
  EXPECT_GT(by_softer, 0.9 * several);
  EXPECT_LT(false_by_softer, 2e-3 * alone);
  EXPECT_LT(by_springs, 0.8 * several) << "the springs that found the answer hide others";
  EXPECT_GT(false_by_springs, 5 * false_by_softer) << "and show some that are none";
}

} // namespace
} // namespace rbvi::several_free_test
