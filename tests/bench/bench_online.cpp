// Seconds per reduced answer, without reconstruction, for the published sizes of membrane_obstacle
// and random operators of about half active constraints.
#include "../model/synthetic.hpp"

#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/model/online.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void measure(const rbvi::synthetic::Sizes &sizes) {
  const rbvi::ReducedModel model = rbvi::synthetic::random_model(sizes, 1);
  const auto start = Clock::now();
  rbvi::OnlineSolver solver(model);
  const double building = seconds_since(start);
  std::vector<double> seconds;
  double residual = 0, active = 0, iterations = 0;
  const auto queries = rbvi::parse_set(model.scene.parameters, "random:400:1");
  for (const rbvi::Mu &mu : queries) {
    const auto query_start = Clock::now();
    const rbvi::ReducedAnswer solution = solver.solve(mu);
    seconds.push_back(seconds_since(query_start));
    residual = std::max(residual, solution.residual);
    active += static_cast<double>((solution.lambda.array() > 0).count());
    iterations += solution.iterations;
  }
  std::sort(seconds.begin(), seconds.end());
  const auto count = static_cast<double>(queries.size());
  std::printf("N %3d S %3d R %3d, terms of a %2d b %d: median %.3f ms, 95%% %.3f ms, building %.2f "
              "ms, active %.0f, updates %.1f, kkt_residual %.1e\n",
              sizes.modes, sizes.supremizers, sizes.generators, sizes.a, sizes.b,
              1e3 * seconds[seconds.size() / 2], 1e3 * seconds[seconds.size() * 19 / 20],
              1e3 * building, active / count, iterations / count, residual);
}

} // namespace

int main() {
  measure({19, 50, 50, 18, 1, 7, 1});
  measure({85, 65, 65, 31, 1, 7, 1});
  measure({85, 65, 65, 31, 5, 7, 5});
  measure({85, 65, 65, 1, 1, 7, 1});
}
