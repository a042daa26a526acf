#include "rbvi/study/output_errors.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/study/bench.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// The largest magnitude of a column: of a component of a force, that of the force.
double magnitude(const OutputColumn &column, const std::vector<Outputs> &truth) {
  double largest = 0;
  for (const Outputs &row : truth) {
    largest = std::max(largest, std::abs(column.of(row).value_or(0)));
    if (column.value == &Outputs::reaction || column.value == &Outputs::horizontal_reaction)
      largest = std::max(largest, std::abs(row.normal_force.value_or(0)));
  }
  return largest;
}

/// Absolute and relative errors of one column.
OutputError error_of(const OutputColumn &column, const std::vector<Outputs> &reduced,
                     const std::vector<Outputs> &truth) {
  std::vector<double> all, values, errors;
  for (std::size_t p = 0; p < truth.size(); ++p) {
    const std::optional<double> known = column.of(truth[p]);
    if (!known) continue;
    all.push_back(*known);
    const std::optional<double> found =
        p < reduced.size() ? column.of(reduced[p]) : std::optional<double>();
    if (!found) continue;
    values.push_back(*known);
    errors.push_back(std::abs(*found - *known));
  }
  OutputError result{column.name};
  if (errors.empty()) return result;
  const auto [low, high] = std::minmax_element(all.begin(), all.end());
  const double least = 1e-2 * magnitude(column, truth);
  const double range = std::max(*high - *low, least);
  const auto count = static_cast<double>(values.size());
  for (std::size_t p = 0; p < values.size(); ++p) {
    const double size = std::max(std::abs(values[p]), least);
    const double of_range = range > 0 ? errors[p] / range : errors[p];
    const double of_value = size > 0 ? errors[p] / size : errors[p];
    result.mean += errors[p] / count;
    result.mean_of_range += of_range / count;
    result.mean_of_value += of_value / count;
    result.max = std::max(result.max, errors[p]);
    result.max_of_range = std::max(result.max_of_range, of_range);
    result.max_of_value = std::max(result.max_of_value, of_value);
  }
  return result;
}

/// How far apart the values are that a length counted by nodes can have; 0 of others.
double step_of(const OutputColumn &column, const std::vector<Outputs> &truth) {
  double step = 0;
  for (const Outputs &row : truth)
    if (column.kind == OutputKind::measure && row.contact_nodes.value_or(0) > 0)
      step = std::max(step, row.contact_measure.value_or(0) / *row.contact_nodes);
  return column.value == &Outputs::contact_measure ? step : step / 2;
}

/// Pressures that are off by more than round-off move nodes in and out of contact or stick: where
/// none of the answers shows it, another one may be off by a step.
void count_steps(const std::vector<Outputs> &truth, std::vector<OutputError> &errors) {
  constexpr double round_off = 1e-8;
  const auto quantity_off = [](const OutputError &error) {
    return output_column(error.name).kind == OutputKind::quantity && error.max_of_value > round_off;
  };
  if (std::ranges::none_of(errors, quantity_off)) return;
  for (OutputError &error : errors) {
    const double step = step_of(output_column(error.name), truth);
    if (step == 0 || error.max_of_value > round_off) continue;
    const double size = magnitude(output_column(error.name), truth);
    error.max = step;
    error.max_of_range = error.max_of_value = size > 0 ? step / size : step;
  }
}

bool has(const std::vector<Outputs> &rows, const OutputColumn &column) {
  return std::ranges::any_of(rows, [&](const Outputs &row) { return column.of(row).has_value(); });
}

} // namespace

Outputs outputs_with_field(const OnlineSolver &solver, const Mu &mu,
                           const ReducedAnswer &solution) {
  Outputs outputs = solver.outputs(mu, solution);
  if (solver.scene().components == 1 && solver.model().fields.basis.rows() > 0)
    outputs.min_u = solver.field(solution).minCoeff();
  return outputs;
}

std::vector<Outputs> reduced_outputs(const ReducedModel &model, const std::vector<Mu> &set,
                                     const std::vector<std::string> &only) {
  OnlineSolver solver(model, {.only = only});
  std::vector<Outputs> rows;
  for (const Mu &mu : set) {
    rows.emplace_back();
    try {
      const ReducedAnswer answer = solver.solve(mu, true);
      rows.back() = asked_of(is_asked(only, "min_u") ? outputs_with_field(solver, mu, answer)
                                                     : solver.outputs(mu, answer),
                             only);
    } catch (const Error &error) {
      if (error.status() == Status::bad_input) throw;
    }
  }
  return rows;
}

double seconds_with_outputs(const ReducedModel &model, const std::vector<Mu> &set,
                            const std::vector<std::string> &only) {
  OnlineSolver solver(model, {.only = only});
  const std::vector<double> seconds = seconds_each(set, [&](const Mu &mu) {
    try {
      (void)solver.outputs(mu, solver.solve(mu, true));
    } catch (const Error &error) { // an answer that is not there takes its time, too
      if (error.status() == Status::bad_input) throw;
    }
  });
  return quantile(seconds, 0.5);
}

std::vector<OutputError> output_errors(const std::vector<Outputs> &reduced,
                                       const std::vector<Outputs> &truth) {
  if (reduced.size() > truth.size())
    throw failure("outputs of " + std::to_string(reduced.size()) + " reduced answers and " +
                  std::to_string(truth.size()) + " high-fidelity ones");
  std::vector<OutputError> errors;
  for (const OutputColumn &column : columns_of(truth))
    if (column.value != &Outputs::seconds && column.value != &Outputs::iterations &&
        has(reduced, column) && has(truth, column))
      errors.push_back(error_of(column, reduced, truth));
  count_steps(truth, errors);
  return errors;
}

double largest_output_error(const std::vector<Outputs> &reduced,
                            const std::vector<Outputs> &truth) {
  double worst = -1;
  for (const OutputError &error : output_errors(reduced, truth))
    if (output_column(error.name).kind == OutputKind::quantity)
      worst = std::max(worst, error.max_of_range);
  return worst;
}

} // namespace rbvi
