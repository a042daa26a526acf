// 100000 random queries of a model file: every KKT residual <= 1e-10, and an answer does not
// depend on the queries before it.
#include "tests/catalogue.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/model/online.hpp"

#include <cstdio>
#include <exception>

namespace {

using namespace rbvi;

struct Extremes {
  double kkt = 0, u = 0, lambda = 0;
  int iterations = 0;
};

Extremes query(const ReducedModel &model) {
  constexpr std::size_t cold_every = 50;
  const std::vector<Mu> queries = parse_set(model.scene.parameters, "random:100000:99");
  OnlineSolver warm(model);
  Extremes worst;
  for (std::size_t k = 0; k < queries.size(); ++k) {
    const ReducedAnswer answer = warm.solve(queries[k]);
    worst.kkt = larger(worst.kkt, answer.residual);
    worst.iterations = std::max(worst.iterations, answer.iterations);
    if (k % cold_every != 0) continue;
    OnlineSolver cold(model);
    const ReducedAnswer again = cold.solve(queries[k]);
    const Vector lambda = cold.multiplier(again);
    worst.u = larger(worst.u, (answer.u - again.u).norm() / again.u.norm());
    worst.lambda = larger(worst.lambda, (warm.multiplier(answer) - lambda).norm() / lambda.norm());
  }
  return worst;
}

} // namespace

int main(int argc, char **argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: stress_online model.h5\n");
    return 2;
  }
  try {
    const Extremes worst = query(read_model(argv[1], catalogue(), false));
    std::printf("largest over 100000 queries: KKT residual %.1e, active-set updates %d; warm "
                "against cold: u %.1e, lambda %.1e\n",
                worst.kkt, worst.iterations, worst.u, worst.lambda);
    return worst.kkt <= 1e-10 && worst.u <= 1e-9 && worst.lambda <= 1e-9 ? 0 : 1;
  } catch (const std::exception &error) {
    std::fprintf(stderr, "stress_online: %s\n", error.what());
    return 1;
  }
}
