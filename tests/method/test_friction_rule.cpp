// Several answers of Coulomb's law: the rule that chooses one, and how others are noticed.
#include "friction_problems.hpp"
#include "rbvi/method/several_answers.hpp"

namespace rbvi::friction_rule_test {
namespace {

/// One node under a coefficient of 2, h_nn - c h_nt < 0. With q = (0.1, 1) there are three answers:
/// apart; slipping, x_n = 0.1 / 0.2, with a negative determinant; and sticking, x = -H^-1 q.
struct OneNode {
  Matrix h{{1, 0.6}, {0.6, 1}};
  Vector q{{0.1, 1}};
  FrictionBound coulomb{2, 0, false};
  Vector slipping{{0.5, -1}};
  Vector sticking = -h.inverse() * q;
  FrictionAnswer from(const Vector &start, bool by_rule = false) const {
    return friction_answer(columns_of(h), q, uniform_laws(1, 2, coulomb), start, by_rule);
  }
};

TEST(FrictionRule, ChoosesOneOfSeveralWhateverTheStart) {
  const OneNode p;
  EXPECT_LT((p.from(p.sticking).x - p.sticking).norm(), 1e-12);
  for (const Vector &start : {Vector(), p.sticking, p.slipping, Vector(-p.q)}) {
    const FrictionAnswer found = p.from(start, true);
    ASSERT_TRUE(found.converged) << found.reason;
    EXPECT_EQ(found.x, Vector::Zero(2)) << "what continues the answer without friction";
    EXPECT_FALSE(found.has_others);
  }
}

TEST(FrictionRule, SeesOthersByTheSignOfTheTangent) {
  const OneNode p;
  const FrictionAnswer found = p.from(p.slipping);
  EXPECT_LT((found.x - p.slipping).norm(), 1e-12);
  EXPECT_TRUE(found.has_others);
  EXPECT_FALSE(p.from(p.sticking).has_others) << "its determinant is positive";
}

TEST(FrictionRule, FindsOthersFromOtherStarts) {
  const OneNode p;
  const NodeLaws laws = uniform_laws(1, 2, p.coulomb);
  std::set<Index> given;
  FrictionSolver solver(once(p.h, given), laws);
  for (const bool by_rule : {false, true})
    for (const Vector &start : {Vector(), p.slipping, p.sticking}) {
      const FrictionAnswer found = solver.answer(p.q, start, by_rule);
      EXPECT_EQ(solver.by_rule(), by_rule);
      EXPECT_GT(distance_to_other_answer(solver, found), 0.1);
      EXPECT_FALSE(solver.another(start, by_rule).converged) << "it would be found again";
    }
  // Pressed together harder there is one.
  const Vector pressed{{-1, 0.1}};
  EXPECT_EQ(distance_to_other_answer(solver, solver.answer(pressed, {}, false)), 0);
  // A threshold is convex.
  const NodeLaws tresca = uniform_laws(1, 2, {0, 0.3, false});
  EXPECT_FALSE(bounds_follow_pressure(tresca));
  EXPECT_TRUE(bounds_follow_pressure(uniform_laws(1, 2, {0, 0.3, true})));
}

/// A threshold that acts in contact alone: with q = (0.2, -2) one node is apart, or slips with
/// x = (0.3, 1), which holds it down. Without friction it is apart.
TEST(FrictionRule, ThresholdsInContactAloneHaveSeveralAnswers) {
  const Matrix h{{1, -0.5}, {-0.5, 1}};
  const Vector q{{0.2, -2}}, slipping{{0.3, 1}};
  FrictionSolver solver(columns_of(h), uniform_laws(1, 2, {0, 1, true}));
  for (const Vector &start : {Vector(), slipping, Vector(-q)}) {
    const FrictionAnswer found = solver.answer(q, start, true);
    ASSERT_TRUE(found.converged) << found.reason;
    EXPECT_EQ(found.x, Vector::Zero(2));
    EXPECT_NEAR(distance_to_other_answer(solver, found), 1, 1e-12);
  }
  const FrictionAnswer held = solver.answer(q, slipping, false);
  EXPECT_LT((held.x - slipping).norm(), 1e-12);
  EXPECT_NEAR(distance_to_other_answer(solver, held), 1, 1e-12);
}

/// The rule comes down from where all that touches sticks: two nodes of which one pushes the other
/// down while it sticks, and lifts it while it slips. Whatever the threshold, as long as both
/// touch.
TEST(FrictionRule, ThresholdsInContactAloneComeDown) {
  Random random(3);
  int touching = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const Matrix h = random_positive(random, 8, 2);
    const Vector q = random.vector(8) - Vector::Unit(8, trial % 4);
    const auto at = [&](double threshold, const Vector &start, bool by_rule) {
      return friction_answer(columns_of(h), q, uniform_laws(4, 2, {0, threshold, true}), start,
                             by_rule);
    };
    const FrictionAnswer stuck = at(1e6, {}, true);
    if (!stuck.converged) continue; // there need not be one
    const double least = stuck.x.tail(4).cwiseAbs().maxCoeff();
    const FrictionAnswer above = at(1.01 * least, {}, true);
    EXPECT_LT((above.x - stuck.x).norm(), 1e-9 * (1 + stuck.x.norm())) << "nothing slips yet";
    touching += stuck.active.empty() ? 0 : 1;
  }
  EXPECT_GT(touching, 20);
}

/// Answers, by every set of nodes whose thresholds in contact may act: what is left there does not
/// jump, and its answer is one of the laws if those nodes touch, and no others of their kind. All
/// answers where no law has a slope.
std::vector<FrictionResult> answers_by_sets(const Matrix &h, const Vector &q,
                                            const NodeLaws &laws) {
  std::vector<FrictionResult> all;
  for (int set = 0; set < 1 << laws.nodes(); ++set) {
    NodeLaws held = laws;
    const auto chosen = [&](Index i) { return (set >> i) % 2 == 1; };
    bool of_jumps = true;
    for (Index i = 0; i < laws.nodes(); ++i)
      if (laws.bound[i].jumps())
        held.bound[i] = laws.bound[i].with_threshold(chosen(i) ? 1 : 0);
      else
        of_jumps = of_jumps && !chosen(i);
    for (FrictionBound &bound : held.bound)
      bound.only_in_contact = false;
    if (!of_jumps) continue;
    FrictionResult found = solve_friction(columns_of(h), q, held);
    bool same = found.converged;
    for (Index i = 0; same && i < laws.nodes(); ++i)
      same = !laws.bound[i].jumps() || chosen(i) == (found.x[laws.normal[i]] > 0);
    if (same) all.push_back(std::move(found));
  }
  return all;
}

/// Beside Coulomb's law, and with a slope of their own. A few are missed: sets may come back that
/// are no answer.
TEST(FrictionRule, ThresholdsInContactAloneStandBesideSlopes) {
  constexpr Index nodes = 6;
  Random random(11);
  int solvable = 0, solved = 0, without = 0;
  for (int trial = 0; trial < 600; ++trial) {
    NodeLaws laws = uniform_laws(nodes, 2 + trial % 2, {0.3, 0, false});
    for (Index i = 0; i < nodes; i += 2)
      laws.bound[i] = {i == 4 ? 0.2 : 0, 0.4, true};
    const Matrix foot = random.matrix(laws.rows, 3);
    const Matrix h = foot * random_positive(random, 3, 0.1) * foot.transpose() +
                     0.3 * Matrix::Identity(laws.rows, laws.rows);
    const Vector q = foot * random.vector(3) + 0.1 * random.vector(laws.rows);
    const bool has_answer = !answers_by_sets(h, q, laws).empty();
    for (const bool by_rule : {false, true}) {
      const FrictionAnswer found = friction_answer(columns_of(h), q, laws, {}, by_rule);
      solvable += has_answer ? 1 : 0;
      solved += found.converged ? 1 : 0;
      without += has_answer ? 0 : 1;
      if (found.converged)
        EXPECT_LT(violation(laws, found.x, found.start), 1e-9);
      else
        EXPECT_EQ(found.reason.find("a threshold that acts in contact alone jumps"), 0U)
            << found.reason;
    }
  }
  EXPECT_GT(solved, 0.995 * solvable);
  EXPECT_LE(solved, solvable);
  EXPECT_GT(without, 50) << "their reason was looked at";
}

/// A rigid foot on an elastic leg: while thresholds come down the rule stays with the nodes that
/// touch as long as they are an answer, whatever others there are, and others are noticed.
TEST(FrictionRule, ThresholdsInContactAloneKeepTheNodesThatTouch) {
  constexpr Index nodes = 5;
  Random random(7);
  Matrix rigid = Matrix::Zero(2 * nodes, 3);
  for (Index i = 0; i < nodes; ++i) {
    rigid(i, 0) = rigid(nodes + i, 2) = 1;
    rigid(i, 1) = 0.5 * static_cast<double>(i) - 1;
  }
  int several = 0, noticed = 0;
  for (int trial = 0; trial < 24; ++trial) {
    const Matrix h = rigid * random_positive(random, 3, 0.1) * rigid.transpose() +
                     0.3 * Matrix::Identity(2 * nodes, 2 * nodes);
    const Vector q = rigid * random.vector(3) + 0.1 * random.vector(2 * nodes);
    std::vector<Index> above;
    for (int step = 0; step < 40; ++step) {
      const double threshold = std::pow(2, 4 - step / 4.0);
      FrictionSolver solver(columns_of(h), uniform_laws(nodes, 2, {0, threshold, true}));
      const FrictionAnswer found = solver.answer(q, {}, true);
      if (step == 0) above = found.active;
      const std::vector<FrictionResult> all = answers_by_sets(h, q, solver.laws());
      const auto same = std::ranges::find(all, above, &FrictionResult::active);
      if (same == all.end()) break;
      ASSERT_TRUE(found.converged) << found.reason;
      EXPECT_LT((found.x - same->x).norm(), 1e-9 * (1 + same->x.norm()));
      several += all.size() > 1 ? 1 : 0;
      noticed += distance_to_other_answer(solver, found) > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(several, 10);
  EXPECT_EQ(noticed, several);
}

/// Where there is one answer the rule finds it, from any guess of the contact, in two and three
/// dimensions.
TEST(FrictionRule, FindsTheOnlyAnswer) {
  Random random(5);
  for (const int dim : {2, 3})
    for (int trial = 0; trial < 20; ++trial) {
      const Index n = 12 * dim;
      const Matrix h = random_positive(random, n, 3);
      const Vector q = random.vector(n);
      for (const FrictionBound &bound : all_bounds) {
        if (bound.jumps()) continue;
        const FrictionResult plain = solve_friction(columns_of(h), q, dim, bound);
        const FrictionAnswer ruled =
            friction_answer(columns_of(h), q, uniform_laws(12, dim, bound), random.vector(n), true);
        ASSERT_TRUE(plain.converged && ruled.converged) << plain.reason << ' ' << ruled.reason;
        EXPECT_LT((plain.x - ruled.x).norm(), 1e-10 * (1 + plain.x.norm()));
        EXPECT_FALSE(ruled.has_others);
      }
    }
}

/// Against differences where sets stay; their system is at hand in the plane alone.
TEST(FrictionSolver, TellsHowAnAnswerChangesWithItsRightSide) {
  Random random(8);
  const Index n = 24;
  const Matrix h = random_positive(random, n, 3);
  const Vector q = random.vector(n), of_q = random.vector(n);
  const double step = 1e-7;
  for (const int dim : {2, 3})
    for (const FrictionBound &bound :
         {FrictionBound{0.4, 0, false}, FrictionBound{0, 0.2, false}, FrictionBound{}}) {
      const bool friction = bound.carries_traction(true);
      FrictionSolver solver(columns_of(h), uniform_laws(n / dim, dim, bound));
      const FrictionAnswer found = solver.answer(q, {}, false);
      EXPECT_EQ(solver.change(of_q, false).size() > 0, friction && dim == 2);
      const Matrix change = solver.change(of_q, true);
      const Matrix far = 1e-9 * solver.change(1e9 * of_q, true);
      EXPECT_LT((far - change).norm(), 1e-12 * change.norm()) << "whatever its size";
      const FrictionAnswer moved = solver.answer(q + step * of_q, found.start, false);
      ASSERT_TRUE(found.converged && moved.converged && found.states == moved.states);
      ASSERT_EQ(change.cols(), 1);
      EXPECT_LT((change - (moved.x - found.x) / step).norm(), 1e-6 * change.norm());
      EXPECT_GT(change.norm(), 0.1);
    }
}

} // namespace
} // namespace rbvi::friction_rule_test
