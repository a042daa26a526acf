#include "rbvi/method/uzawa.hpp"

#include "rbvi/core/largest.hpp"

#include <cmath>

namespace rbvi {

namespace {

/// Largest eigenvalue of H by power iterations from `first`, to 1 %, rounded up by as much.
double largest_eigenvalue(const UzawaProblem &p, const Vector &first) {
  Vector x = first / std::sqrt(p.dot(first, first));
  double estimate = 0;
  for (int k = 0; k < 100; ++k) {
    x = p.times_h(x);
    const double previous = estimate;
    estimate = std::sqrt(p.dot(x, x));
    if (std::abs(estimate - previous) <= 1e-2 * estimate) break;
    x /= estimate;
  }
  return 1.01 * estimate;
}

/// (3.19): the change of either part against its own size.
double relative_change(const UzawaProblem &p, const Vector &change, const Vector &x) {
  const std::array<double, 2> by = p.sizes(change), size = p.sizes(x);
  const auto ratio = [&](std::size_t part) { return by[part] == 0 ? 0 : by[part] / size[part]; };
  return larger(ratio(0), ratio(1));
}

/// Nesterov's extrapolation from `extrapolated` beyond `next`, started again when it overshoots.
/// `change`: from the multipliers before.
Vector beyond(const UzawaProblem &p, const Vector &extrapolated, const Vector &next,
              const Vector &change, double &momentum) {
  const bool overshot = p.dot(extrapolated, change) > p.dot(next, change);
  const double grown = overshot ? 1 : (1 + std::sqrt(1 + 4 * momentum * momentum)) / 2;
  const double factor = overshot ? 0 : (momentum - 1) / grown;
  momentum = grown;
  return next + factor * change;
}

} // namespace

UzawaResult solve_uzawa(const UzawaProblem &problem, const UzawaOptions &options) {
  const auto usual_step = [&] { // H p.first is zero where obstacles push from both sides
    const double largest = largest_eigenvalue(problem, problem.first);
    return 1 / (largest > 0 ? largest : largest_eigenvalue(problem, problem.q));
  };
  const double step = options.step > 0 ? options.step : usual_step();
  UzawaResult result{Vector::Zero(problem.q.size())};
  Vector extrapolated = result.x;
  double momentum = 1;
  while (!result.converged && result.iterations < options.max_iterations) {
    ++result.iterations;
    const Vector w = problem.times_h(extrapolated) + problem.q;
    Vector next = problem.projection(extrapolated - step * w);
    const Vector change = next - result.x;
    result.change = relative_change(problem, change, next);
    result.converged = result.change <= options.tolerance &&
                       (result.iterations > 1 || problem.dot(next, next) == 0);
    extrapolated =
        options.accelerated ? beyond(problem, extrapolated, next, change, momentum) : next;
    result.x = std::move(next);
  }
  return result;
}

} // namespace rbvi
