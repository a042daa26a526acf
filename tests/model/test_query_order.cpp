// Answers do not depend on the queries before.
#include "synthetic.hpp"

#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/model/training_samples.hpp"

#include <gtest/gtest.h>

namespace rbvi::query_order_test {
namespace {

/// More generators than functions: the multipliers are not unique, and a start chooses some.
ReducedModel model_of_dependent_generators(bool trained) {
  ReducedModel model = synthetic::random_model({4, 2, 12, 2, 1, 1, 2}, 3);
  if (trained)
    model.made.trained_mu = as_columns(parse_set(model.scene.parameters, "grid:2,2,2"), 3);
  return model;
}

/// The factors of a start may be updated ones, or made anew: the same to round-off.
double distance(const Vector &one, const Vector &other) {
  return (one - other).norm() / other.norm();
}

TEST(OrderOfQueries, DoesNotMatter) {
  for (const bool trained : {false, true}) {
    const ReducedModel model = model_of_dependent_generators(trained);
    const std::vector<Mu> set = parse_set(model.scene.parameters, "random:40:1");
    OnlineSolver forwards(model), backwards(model);
    std::vector<ReducedAnswer> first;
    for (const Mu &mu : set)
      first.push_back(forwards.solve(mu));
    for (std::size_t k = set.size(); k-- > 0;) {
      const ReducedAnswer again = backwards.solve(set[k]);
      EXPECT_LE(distance(again.lambda, first[k].lambda), 1e-12);
      EXPECT_LE(distance(again.u, first[k].u), 1e-12);
      EXPECT_EQ(again.iterations, first[k].iterations);
      if (k % 10 > 0) continue;
      EXPECT_LE(distance(OnlineSolver(model).solve(set[k]).lambda, first[k].lambda), 1e-12);
    }
  }
}

TEST(OrderOfQueries, MattersWhereItIsAskedFor) {
  const ReducedModel model = model_of_dependent_generators(true);
  OnlineSolver warm(model, QueryOptions{.warm = true}), cold(model);
  const Mu mu{0.19, 0.01, 0.02};
  const ReducedAnswer first = warm.solve(mu), again = warm.solve(mu);
  EXPECT_GT(first.iterations, 0);
  EXPECT_EQ(again.iterations, 0) << "its own active set";
  EXPECT_LT((again.u - cold.solve(mu).u).norm(), 1e-10 * again.u.norm());
}

/// With one term of A and of B factors are kept beside the active sets.
TEST(StoredStarts, AreThoseThatAreFoundWhenAskedFor) {
  for (const int terms : {1, 2}) {
    ReducedModel model = synthetic::random_model({6, 4, 8, terms, 1, 1, 2}, 5), stored = model;
    const std::vector<Mu> training = parse_set(model.scene.parameters, "grid:2,2,2");
    stored.contact.starts = Matrix::Zero(8, 8);
    for (Index k = 0; k < 7; ++k) // not of the last one
      stored.contact.starts.col(k) = OnlineSolver(model).solve(training[k]).lambda;
    model.made.trained_mu = stored.made.trained_mu = as_columns(training, 3);
    check_model(stored);
    OnlineSolver finds(model), knows(stored);
    for (const Mu &mu : parse_set(model.scene.parameters, "random:40:1")) {
      const ReducedAnswer found = finds.solve(mu), known = knows.solve(mu);
      EXPECT_LE(distance(known.lambda, found.lambda), 1e-12) << terms;
      EXPECT_EQ(known.iterations, found.iterations) << terms;
    }
    EXPECT_EQ(OnlineSolver(stored).solve(training[3]).iterations, 0) << terms;
    stored.contact.starts = Matrix::Zero(8, 3);
    EXPECT_THROW(check_model(stored), Error) << "of other samples";
    EXPECT_EQ(leading(stored, 9, 8).contact.starts.size(), 0) << "answers of another model";
  }
}

} // namespace
} // namespace rbvi::query_order_test
