#include "tests/catalogue.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/study/bench.hpp"
#include "rbvi/study/output_errors.hpp"

#include <gtest/gtest.h>

namespace rbvi::bench_test {

namespace {

std::vector<Sample> solved(Problem &problem, const std::vector<Mu> &set) {
  HighFidelity solver(problem, {});
  std::vector<Sample> samples;
  for (const Mu &mu : set) {
    HfSolution answer = solver.solve(mu);
    samples.push_back({mu, answer.u, answer.lambda, answer.outputs});
  }
  return samples;
}

} // namespace

TEST(Bench, QuantilesAreValuesThatWereMeasured) {
  EXPECT_EQ(quantile({3, 1, 2}, 0.5), 2);
  EXPECT_EQ(quantile({3, 1, 2}, 0.95), 3);
  EXPECT_EQ(quantile({7}, 0.5), 7);
  EXPECT_THROW(quantile({}, 0.5), Error);
}

TEST(Bench, ErrorsVanishAtTheSnapshotsAndNotBetween) {
  Problem problem(PETSC_COMM_SELF, make_scene("membrane_obstacle"), {});
  const ParameterSpace &space = problem.scene().parameters;
  const std::vector<Sample> snapshots = solved(problem, parse_set(space, "grid:2,2,1"));
  const std::vector<Sample> between = solved(problem, {{0.2, 0, 0}});

  const BenchRow solver = bench_solver(problem, {}, snapshots, 3, From::cold);
  EXPECT_EQ(solver.queries, 3);
  EXPECT_LT(std::max(solver.u_max, solver.lambda_max), 1e-10);
  EXPECT_GT(solver.median, 0);
  EXPECT_LT(solver.outputs_max, 1e-9);
  EXPECT_GE(solver.outputs_max, 0);
  const BenchRow exact = bench_interpolation(problem, snapshots, snapshots);
  EXPECT_LT(std::max(exact.u_max, exact.lambda_max), 1e-14);
  const BenchRow coarse = bench_interpolation(problem, snapshots, between);
  EXPECT_GT(coarse.u_max, 1e-3);
  EXPECT_LT(coarse.u_max, 1e-1);
  EXPECT_LT(std::abs(exact.outputs_max), 1e-14);
  EXPECT_GT(coarse.outputs_max, 1e-3);
}

TEST(Bench, ASolverWithoutAnAnswerSaysWhyAndHasNoTimes) {
  Problem problem(PETSC_COMM_SELF, make_scene("membrane_obstacle"), {});
  const std::vector<Sample> truths = solved(problem, {{0.2, 0, 0}});
  HfOptions options;
  options.method = HfMethod::uzawa;
  options.uzawa.max_iterations = 1;
  const BenchRow row = bench_solver(problem, options, truths, 1, From::cold);
  EXPECT_EQ(row.queries, 0);
  EXPECT_LT(row.u_max, 0);
  EXPECT_NE(row.includes.find("no answer: no convergence"), std::string::npos) << row.includes;
}

TEST(Bench, OutputsAreComparedWithTheRangeOfTheirTrueValues) {
  const auto outputs = [](double energy, double force) {
    Outputs result;
    result.energy = energy;
    result.normal_force = force;
    result.contact_measure = 1e3 * force; // counted, not compared
    return result;
  };
  const std::vector<Outputs> truths{outputs(-2, 100), outputs(2, 100), outputs(1, 100)};
  EXPECT_EQ(largest_output_error(truths, truths), 0);
  EXPECT_DOUBLE_EQ(largest_output_error({outputs(-2, 100), outputs(2.4, 100)}, truths), 0.1);
  EXPECT_DOUBLE_EQ(largest_output_error({outputs(-2, 100.5)}, truths), 0.5); // of 1 % of 100
  EXPECT_LT(largest_output_error({Outputs{}}, truths), 0);
}

} // namespace rbvi::bench_test
