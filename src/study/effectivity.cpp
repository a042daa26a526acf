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

/// A high-fidelity answer and the reduced one there.
struct Compared {
  Outputs truth, reduced;
  double size, distance; ///< |u| and |u - u_N|
  double most;           ///< what is told of the latter
};

/// What errors of the high-fidelity solver, and of the factors that bounds are made with, leave of
/// its outputs and displacements: those of a slender body are known to 1e-9. Of the largest answer,
/// as some may be zero.
constexpr double of_solver = 1e-8;

/// Of the outputs whose interval an answer tells; `energy`, `force`: the largest of all answers.
void compare_intervals(const Compared &one, double energy, double force, Effectivities &found) {
  for (const OutputColumn &column : output_columns()) {
    const auto within = interval_of(one.reduced, column.name);
    const std::optional<double> value = column.of(one.truth);
    if (!within || !value) continue;
    const auto [lower, upper] = *within;
    const double size = column.size == Size::energy ? energy : force;
    double &width = found.widths[column.name];
    width = std::max(width, (upper - lower) / size);
    if (!(*value >= lower - of_solver * size && *value <= upper + of_solver * size)) ++found.wrong;
  }
}

Effectivities effectivities_of(const std::vector<Compared> &all) {
  Effectivities found;
  double size = 0, energy = 0, force = 0;
  for (const Compared &one : all) {
    size = std::max(size, one.size);
    energy = std::max(energy, std::pow(*one.reduced.energy_norm, 2));
    force = std::max(force, std::abs(one.truth.normal_force.value_or(0)));
  }
  for (const Compared &one : all) {
    compare_intervals(one, energy, force, found);
    if (one.distance <= of_solver * size) {
      ++found.exact;
      continue;
    }
    const bool certified = one.reduced.error_bound.has_value();
    (certified ? found.values : found.indicators).push_back(one.most / one.distance);
    if (certified && !(one.most + of_solver * size >= one.distance)) ++found.wrong;
  }
  return found;
}

} // namespace

Effectivities effectivities(Problem &problem, const ReducedModel &model,
                            const std::vector<Sample> &samples) {
  std::vector<Compared> all;
  if (!model.certificate.exists()) return {};
  int without = 0;
  OnlineSolver solver(model, {.only = names_of_bounds()});
  for (const Sample &sample : samples) {
    Compared one{.truth = sample.outputs};
    Vector error = sample.u;
    try {
      const ReducedAnswer answer = solver.solve(sample.mu, true);
      one.reduced = solver.outputs(sample.mu, answer);
      error -= solver.field(answer);
    } catch (const Error &) { // told where errors are
      continue;
    }
    const std::optional<double> bound =
        one.reduced.error_bound ? one.reduced.error_bound : one.reduced.error_indicator;
    if (!bound) {
      ++without;
      continue;
    }
    const Operators &op = problem.assemble(sample.mu);
    one.size = energy_norm(op.a, from_natural(problem.dofs(), sample.u).get());
    one.distance = energy_norm(op.a, from_natural(problem.dofs(), error).get());
    one.most = *bound * *one.reduced.energy_norm / std::sqrt(image_count(problem.scene().mirrors));
    all.push_back(std::move(one));
  }
  Effectivities found = effectivities_of(all);
  found.without = without;
  return found;
}

void print_effectivities(std::ostream &out, const Effectivities &found) {
  if (!found.values.empty()) out << told("Bounds of u", found.values) << '\n';
  if (!found.indicators.empty()) out << told("Indicators of u", found.indicators) << '\n';
  for (const auto &[output, width] : found.widths)
    out << "Intervals of " << output << ": at most " << short_number(width) << " of the largest "
        << (output == "energy" ? "a(u, u)" : "normal force") << " wide\n";
  if (found.exact > 0)
    out << counted(found.exact, "answer") << " with a bound as exact as the high-fidelity ones\n";
  if (found.without > 0) out << counted(found.without, "answer") << " without a bound\n";
}

} // namespace rbvi
