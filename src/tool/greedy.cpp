#include "greedy.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/mor/certificate.hpp"
#include "rbvi/par/collective.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

/// In parts of the box.
double distance(const ParameterSpace &space, const Mu &one, const Mu &other) {
  double square = 0;
  for (int i = 0; i < space.size(); ++i) {
    const double part = (one[i] - other[i]) / (space.at(i).upper - space.at(i).lower);
    square += part * part;
  }
  return std::sqrt(square);
}

double to_nearest(const ParameterSpace &space, const Mu &mu, const std::vector<Mu> &set) {
  double least = std::numeric_limits<double>::infinity();
  for (const Mu &other : set)
    least = std::min(least, distance(space, mu, other));
  return least;
}

/// Of the answer at mu; infinite where it has none.
double bound_at(OnlineSolver &solver, const Mu &mu) {
  try {
    const Outputs outputs = solver.outputs(mu, solver.solve(mu));
    const std::optional<double> bound =
        outputs.error_bound ? outputs.error_bound : outputs.error_indicator;
    return bound.value_or(std::numeric_limits<double>::infinity());
  } catch (const Error &) {
    return std::numeric_limits<double>::infinity();
  }
}

} // namespace

GreedyPool greedy_pool(const OfflineOptions &options) {
  if (options.greedy.empty()) return {};
  const std::string none = no_certificate(options.scene);
  if (!none.empty())
    throw bad_input("-greedy chooses samples by bounds of errors, and there are none: " + none);
  if (!options.reduce.certify) throw bad_input("-greedy needs bounds of errors: add -certify");
  return {parse_set(options.scene.parameters, options.greedy, false, options.scene.outputs),
          options.greedy_tolerance, static_cast<std::size_t>(options.greedy_samples)};
}

NextSamples next_samples(MPI_Comm world, const ReducedModel &model, const Scene &scene,
                         const std::vector<Mu> &pool, const std::vector<Mu> &taken,
                         std::size_t count) {
  Vector bounds = Vector::Zero(std::ssize(pool));
  OnlineSolver solver(model, scene, {.only = {"error_bound", "error_indicator"}});
  take_turns(world, pool.size(),
             [&](std::size_t p) { bounds[static_cast<Index>(p)] = bound_at(solver, pool[p]); });
  over_ranks(world, MPI_SUM, bounds);
  std::vector<std::size_t> order;
  for (std::size_t p = 0; p < pool.size(); ++p)
    if (std::ranges::find(taken, pool[p]) == taken.end()) order.push_back(p);
  std::ranges::stable_sort(order, std::greater(),
                           [&](std::size_t p) { return bounds[static_cast<Index>(p)]; });
  NextSamples next;
  if (order.empty()) return next;
  next.largest = bounds[static_cast<Index>(order.front())];
  const ParameterSpace &space = scene.parameters;
  const double apart = to_nearest(space, pool[order.front()], taken) / 2;
  for (const std::size_t p : order)
    if (next.mu.size() < count && (next.mu.empty() || to_nearest(space, pool[p], next.mu) > apart))
      next.mu.push_back(pool[p]);
  return next;
}

} // namespace rbvi
