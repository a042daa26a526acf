#include "rbvi/model/gradient.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
/// Of the box, or of the value of a parameter that has one sign: there truncation, h^2, and
/// round-off, 1e-15 / h, are alike.
constexpr double relative_step = 1e-5;

double step_of(const Parameter &parameter, double value) {
  const double width = parameter.upper - parameter.lower;
  const bool one_sign = parameter.lower > 0 || parameter.upper < 0;
  return relative_step * (one_sign ? std::min(width, std::abs(value)) : width);
}

/// A difference quotient of second order: sum of weight * f(mu + steps * h) / h.
struct Quotient {
  double step;
  struct Term {
    int steps;
    double weight;
  };
  std::vector<Term> terms;
};

/// Both sides, or where that would leave the box one.
Quotient quotient_at(const Parameter &parameter, double value) {
  const double h = step_of(parameter, value);
  const bool inside = value >= parameter.lower && value <= parameter.upper;
  if (inside && value - h < parameter.lower) return {h, {{0, -1.5}, {1, 2}, {2, -0.5}}};
  if (inside && value + h > parameter.upper) return {h, {{0, 1.5}, {-1, -2}, {-2, 0.5}}};
  return {h, {{1, 0.5}, {-1, -0.5}}};
}

bool has_gradient(const OutputColumn &column) {
  return column.kind == OutputKind::quantity;
}

} // namespace

OutputGradient gradient_of(OnlineSolver &solver, const Mu &mu, const ReducedAnswer &answer,
                           const std::vector<OutputColumn> &columns) {
  const ParameterSpace &space = solver.scene().parameters;
  OutputGradient result{Matrix::Zero(std::ssize(columns), space.size()),
                        std::vector<bool>(static_cast<std::size_t>(space.size()), false)};
  for (int p = 0; p < space.size(); ++p) {
    if (!space.at(p).choices.empty()) {
      result.values.col(p).setConstant(unknown);
      continue;
    }
    const auto [step, terms] = quotient_at(space.at(p), mu[p]);
    for (const auto &[steps, weight] : terms) {
      Mu moved = mu;
      moved[p] += steps * step;
      const ReducedAnswer near = solver.near(answer, moved);
      const Outputs there = solver.outputs(moved, near);
      if (near.passes_kink) result.kinked[p] = true;
      for (std::size_t c = 0; c < columns.size(); ++c)
        result.values(static_cast<Index>(c), p) +=
            has_gradient(columns[c]) ? weight / step * columns[c].of(there).value_or(unknown)
                                     : unknown;
    }
  }
  return result;
}

void add_gradient(const OutputGradient &gradient, const std::vector<OutputColumn> &columns,
                  const ParameterSpace &space, Outputs &outputs) {
  for (std::size_t c = 0; c < columns.size(); ++c)
    for (int p = 0; p < space.size() && has_gradient(columns[c]); ++p)
      outputs.named.push_back({"d_" + columns[c].name + "_d_" + space.at(p).name,
                               gradient.values(static_cast<Index>(c), p)});
}

} // namespace rbvi
