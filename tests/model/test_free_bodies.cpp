// Queries of bodies that contact alone holds, of a contact problem that is one equation.
#include "rbvi/model/free_bodies.hpp"

#include "rbvi/core/error.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::free_bodies_test {
namespace {

constexpr double load = 1.2, farthest = 1.1;

/// One motion, one node: lambda = beta + beta^5, and no answer where beta is above `farthest`.
class Stiffening : public QueryMethod {
public:
  ReducedAnswer solve(const FullMu &mu, Relaxed relaxed) override {
    const double beta = relaxed.beta[0];
    if (failed_) {
      EXPECT_EQ(relaxed.before.lambda.size(), 0);
      EXPECT_FALSE(relaxed.before.motions);
      went_on_ = true;
    }
    failed_ = beta > farthest;
    if (failed_) throw failure("no answer here");
    ReducedAnswer answer;
    answer.mu = mu;
    answer.lambda = Vector::Constant(1, beta + std::pow(beta, 5));
    answer.iterations = 1;
    answer.motions = FreeMotions{uniform_laws(1, 1, {}), Matrix::Ones(1, 1),
                                 Vector::Constant(1, load), Vector::Constant(1, load)};
    return answer;
  }
  void displace(ReducedAnswer &answer) override { answer.u = answer.lambda; }
  bool went_on() const { return went_on_; } ///< after a solve that failed, from no answer

private:
  bool failed_ = false, went_on_ = false;
};

TEST(FreeBodies, AQueryGoesOnAfterAContactProblemWithoutAnswer) {
  Scene scene;
  scene.a.push_back(exact_term({}));
  ReducedModel model;
  model.body.springs = Matrix::Ones(1, 1);
  model.body.spring_terms = {0};
  model.body.motions = Matrix::Zero(1, 1);
  Stiffening method;
  const ReducedAnswer answer = solve_balanced(method, model, scene, {});
  EXPECT_TRUE(method.went_on());
  EXPECT_NEAR(answer.lambda[0], load, 1e-10 * load);
  EXPECT_EQ(answer.u, answer.lambda);
  EXPECT_GT(answer.iterations, 2);
  const double beta = std::sqrt(2 * answer.energy); // of the spring alone
  EXPECT_NEAR(beta + std::pow(beta, 5), load, 1e-9);
}

} // namespace
} // namespace rbvi::free_bodies_test
