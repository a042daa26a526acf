#include "synthetic.hpp"

#include "rbvi/core/box.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/model/self_check.hpp"

#include <gtest/gtest.h>
#include <sstream>

namespace rbvi::self_check_test {
namespace {

std::string printed(const SelfCheck &check, const ReducedModel &model) {
  std::ostringstream out;
  print_self_check(out, check, model.scene.parameters);
  return out.str();
}

bool contains(const std::string &text, const std::string &part) {
  return text.find(part) != std::string::npos;
}

TEST(SelfCheck, FindsTheLargestOfEachAndWhere) {
  const ReducedModel model = synthetic::random_model({3, 2, 4, 3, 1, 1, 2}, 21);
  const SelfCheck check = self_check(model, model.scene, 30);
  EXPECT_EQ(check.queries, 44);
  EXPECT_EQ(check.at_boundary, 14);
  EXPECT_EQ(check.unanswered, 0);
  EXPECT_TRUE(check.answered());
  OnlineSolver solver(model);
  const Outputs there = solver.outputs(check.penetration.at, solver.solve(check.penetration.at));
  EXPECT_NEAR(*there.max_penetration, check.penetration.value, 1e-9);
  std::vector<Mu> set = parse_set(model.scene.parameters, "random:30:17");
  for (const Mu &mu : corners_and_faces(model.scene.parameters))
    set.push_back(mu);
  double displacement = 0;
  for (const Mu &mu : set) {
    const ReducedAnswer solution = solver.solve(mu);
    EXPECT_LE(*solver.outputs(mu, solution).max_penetration, check.penetration.value + 1e-9);
    displacement = std::max(displacement, (model.contact.trace * solution.u).cwiseAbs().maxCoeff());
  }
  EXPECT_NEAR(check.scale, displacement, 1e-9 * displacement);
  EXPECT_TRUE(contains(printed(check, model),
                       "30 random queries and 14 at corners and faces of the box, all answered"));
}

TEST(SelfCheck, IsTheSameEveryTime) {
  const ReducedModel model = synthetic::random_model({3, 2, 4, 3, 1, 1, 2}, 21);
  const SelfCheck one = self_check(model, model.scene, 20),
                  two = self_check(model, model.scene, 20);
  EXPECT_EQ(one.residual.value, two.residual.value);
  EXPECT_EQ(one.residual.at, two.residual.at);
}

TEST(SelfCheck, SaysWhatHasNoAnswer) {
  ReducedModel model = synthetic::random_model({3, 2, 4, 3, 1, 1, 2}, 21);
  model.body.a.reduced *= -1; // not positive definite
  const SelfCheck check = self_check(model, model.scene, 10);
  EXPECT_EQ(check.unanswered, 24);
  EXPECT_EQ(check.unanswered_at, parse_set(model.scene.parameters, "random:1:17")[0]);
  EXPECT_FALSE(check.clean());
  const std::string text = printed(check, model);
  EXPECT_TRUE(contains(text, "24 without an answer")) << text;
  EXPECT_TRUE(contains(text, "not positive definite")) << text;
  EXPECT_TRUE(contains(text, "reduce again")) << text;
  EXPECT_TRUE(contains(printed({}, model), "not made"));
  SelfCheck rough;
  rough.queries = 5;
  rough.residual = {1e-7, model.scene.parameters.size() == 3 ? Mu{0.2, 0, 0} : Mu{}};
  EXPECT_FALSE(rough.clean());
  EXPECT_TRUE(contains(printed(rough, model), "residuals above 1e-10"));
}

/// Residuals of round-off say nothing of what the model does not know.
TEST(SelfCheck, IsNotCleanWhereBodiesPenetrateOrFrictionExceedsItsBound) {
  const ReducedModel model = synthetic::random_model({3, 2, 4, 3, 1, 1, 2}, 21);
  SelfCheck check;
  check.queries = 5;
  check.scale = 0.1;
  check.residual = {1e-14, {0.2, 0, 0}};
  check.penetration = {1e-3, {0.2, 0, 0}};
  EXPECT_TRUE(check.clean());
  EXPECT_FALSE(contains(printed(check, model), "reduce again")) << printed(check, model);
  for (const double bad : {0.02, std::nan("")}) {
    check.penetration.value = bad;
    EXPECT_TRUE(check.answered());
    EXPECT_FALSE(check.clean());
    EXPECT_TRUE(contains(printed(check, model), "bodies penetrate")) << printed(check, model);
  }
  check.penetration.value = 1e-3;
  check.friction = {0.2, {0.2, 0, 0}};
  EXPECT_FALSE(check.clean());
  EXPECT_TRUE(contains(printed(check, model), "friction exceeds its bound"));
}

/// Where something is not finite between the training parameters the rest of the box has answers.
TEST(SelfCheck, CountsBadInputAmongWhatHasNoAnswer) {
  const ReducedModel model = synthetic::random_model({3, 2, 4, 3, 1, 1, 2}, 21);
  Scene scene = model.scene;
  const Mu second = parse_set(model.scene.parameters, "random:2:17")[1];
  scene.contacts.front().coefficients = {
      {"height", [second](const FullMu &mu) { return 1 / (mu[0] - second[0]); }}};
  const SelfCheck check = self_check(model, scene, 10);
  EXPECT_EQ(check.unanswered, 1);
  EXPECT_EQ(check.unanswered_at, second);
  EXPECT_TRUE(
      contains(check.reason, "the height of contact 'obstacle' on 'obstacle' is not finite at"))
      << check.reason;
  EXPECT_LE(check.residual.value, 1e-10);
}

} // namespace
} // namespace rbvi::self_check_test
