// The high-fidelity active set method from random starts, over both disc maps, both quadratures,
// loads of all sizes and the ends of the box: every answer's KKT residual <= 1e-12.
#include "tests/catalogue.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/solve/methods.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <random>

using namespace rbvi;

namespace {

constexpr int queries_per_case = 72; ///< 2 maps x 2 quadratures x 7 loads: 2016 solves

class RandomQueries {
public:
  Mu mu(const ParameterSpace &space) {
    Mu result;
    for (int i = 0; i < space.size(); ++i) {
      const double s = uniform_(engine_), end = std::floor(2 * uniform_(engine_));
      const double fraction = uniform_(engine_) < 1.0 / 3 ? end : s;
      result.push_back(space.at(i).lower + fraction * (space.at(i).upper - space.at(i).lower));
    }
    return result;
  }
  /// Each node with a probability that is random itself; now and then none or all.
  std::vector<Index> start(Index size) {
    const double share = 1.2 * uniform_(engine_) - 0.1;
    std::vector<Index> result;
    for (Index i = 0; i < size; ++i)
      if (uniform_(engine_) < share) result.push_back(i);
    return result;
  }

private:
  std::mt19937 engine_{12345};
  std::uniform_real_distribution<double> uniform_{0, 1};
};

struct Case {
  const char *disc_map, *lumped, *load;
};

class HighFidelityStress : public testing::TestWithParam<Case> {};

} // namespace

TEST_P(HighFidelityStress, EveryRandomStartEndsAtAnExactAnswer) {
  const auto &[disc_map, lumped, load] = GetParam();
  const SceneOptions options{{"disc_map", disc_map}, {"lumped", lumped}, {"load", load}};
  Problem problem(PETSC_COMM_SELF, make_scene("membrane_obstacle", options), {});
  const Handle<KSP> ksp = make_direct_solver(PETSC_COMM_SELF, "hf_");
  const ParameterSpace &space = problem.scene().parameters;
  RandomQueries random;
  double worst = 0;
  int iterations = 0, backup = 0;
  for (int k = 0; k < queries_per_case; ++k) {
    const Mu mu = random.mu(space);
    const std::vector<Index> start = random.start(problem.dual_size());
    SCOPED_TRACE(describe(space, mu) + ", " + std::to_string(start.size()) + " nodes at the start");
    const Operators &op = problem.assemble(mu);
    RBVI_CALL(KSPSetOperators(ksp.get(), op.a, op.a));
    FactoredBody body(ksp.get(), problem.trace(), ColumnsLast::for_one_b);
    body.set(op.a);
    Vector guess = Vector::Zero(problem.dual_size());
    guess(start).setOnes();
    const MethodResult result = solve_active_set(body, op, guess);
    ASSERT_TRUE(result.converged) << result.reason;
    const double kkt =
        kkt_residual(problem.trace(), op, result.free_u.get(), result.lambda).largest();
    EXPECT_LE(kkt, 1e-12);
    worst = larger(worst, kkt);
    iterations = std::max(iterations, result.iterations);
    backup += result.iterations > 50 ? 1 : 0;
  }
  std::printf("  KKT residual %.1e, iterations %d at most, above 50 in %d of %d\n", worst,
              iterations, backup, queries_per_case);
}

namespace {

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const char *map : {"similarity", "graded"})
    for (const char *lumped : {"no", "yes"})
      for (const char *load : {"-1", "-25", "-200", "-10000", "0", "1", "10000"})
        cases.push_back({map, lumped, load});
  return cases;
}

} // namespace

INSTANTIATE_TEST_SUITE_P(Membrane, HighFidelityStress, testing::ValuesIn(all_cases()));
