#include "rbvi/study/effectivity.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/model/online.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>

namespace rbvi {

namespace {

/// |u| in the norm of A. Collective.
double energy_norm(Mat a, Vec u) {
  Handle<Vec> product;
  PetscScalar square = 0;
  RBVI_CALL(VecDuplicate(u, product.put()));
  RBVI_CALL(MatMult(a, u, product.get()));
  RBVI_CALL(VecDot(u, product.get(), &square));
  return std::sqrt(std::max(0.0, square));
}

std::string told(const char *what, std::vector<double> values) {
  std::ranges::sort(values);
  return std::string(what) + ": " + short_number(values.front()) + " to " +
         short_number(values.back()) + " times the error in the energy norm, median " +
         short_number(values[values.size() / 2]) + ", over " +
         counted(std::ssize(values), "answer");
}

/// Of the outputs whose interval the answer tells. `energy`: one beside which errors of the
/// high-fidelity solver are small.
void compare_intervals(const Outputs &reduced, const Outputs &truth, double energy,
                       Effectivities &found) {
  constexpr double of_solver = 1e-10;
  for (const OutputColumn &column : output_columns()) {
    const auto within = interval_of(reduced, column.name);
    const std::optional<double> value = column.of(truth);
    if (!within || !value) continue;
    const auto [lower, upper] = *within;
    const double scale = column.size == Size::energy ? energy : truth.normal_force.value_or(0),
                 size = std::max({std::abs(*value), std::abs(lower), scale});
    double &width = found.widths[column.name];
    width = std::max(width, (upper - lower) / size);
    if (!(*value >= lower - of_solver * size && *value <= upper + of_solver * size)) ++found.wrong;
  }
}

} // namespace

Effectivities effectivities(Problem &problem, const ReducedModel &model,
                            const std::vector<Sample> &samples) {
  constexpr double of_solver = 1e-8;
  Effectivities found;
  if (!model.certificate.exists()) return found;
  OnlineSolver solver(model, {.only = names_of_bounds()});
  for (const Sample &sample : samples) {
    Outputs outputs;
    Vector error = sample.u;
    try {
      const ReducedAnswer answer = solver.solve(sample.mu, true);
      outputs = solver.outputs(sample.mu, answer);
      error -= solver.field(answer);
    } catch (const Error &) { // told where errors are
      continue;
    }
    const std::optional<double> bound =
        outputs.error_bound ? outputs.error_bound : outputs.error_indicator;
    if (!bound) {
      ++found.without;
      continue;
    }
    compare_intervals(outputs, sample.outputs, std::pow(*outputs.energy_norm, 2), found);
    const Operators &op = problem.assemble(sample.mu);
    const double size = energy_norm(op.a, from_natural(problem.dofs(), sample.u).get()),
                 distance = energy_norm(op.a, from_natural(problem.dofs(), error).get()),
                 images = std::sqrt(image_count(problem.scene().mirrors));
    if (distance <= of_solver * size) {
      ++found.exact;
      continue;
    }
    const double most = *bound * *outputs.energy_norm / images;
    (outputs.error_bound ? found.values : found.indicators).push_back(most / distance);
    if (outputs.error_bound && !(most + of_solver * size >= distance)) ++found.wrong;
  }
  return found;
}

void print_effectivities(std::ostream &out, const Effectivities &found) {
  if (!found.values.empty()) out << told("Bounds of u", found.values) << '\n';
  if (!found.indicators.empty()) out << told("Indicators of u", found.indicators) << '\n';
  for (const auto &[output, width] : found.widths)
    out << "Intervals of " << output << ": at most " << short_number(width) << " of it wide\n";
  if (found.exact > 0)
    out << counted(found.exact, "answer") << " with a bound as exact as the high-fidelity ones\n";
  if (found.without > 0) out << counted(found.without, "answer") << " without a bound\n";
}

} // namespace rbvi
