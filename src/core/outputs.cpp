#include "rbvi/core/outputs.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <cstdio>
#include <iomanip>

namespace rbvi {

namespace {

std::string ten_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

} // namespace

const std::vector<OutputColumn> &output_columns() {
  using enum OutputKind;
  static const std::vector<OutputColumn> columns{
      {"energy", &Outputs::energy, quantity, "J(u) = a(u, u) / 2 - f(u)"},
      {"normal_force", &Outputs::normal_force, quantity, "integral of the contact pressure"},
      {"tangential_force", &Outputs::tangential_force, quantity,
       "integral of the magnitude of the tangential stress"},
      {"reaction", &Outputs::reaction, quantity, "vertical force of the support on the body"},
      {"contact_measure", &Outputs::contact_measure, measure,
       "length or area in contact: weights of the nodes with pressure"},
      {"contact_half_width", &Outputs::contact_half_width, measure, "half of contact_measure"},
      {"stick_half_width", &Outputs::stick_half_width, measure,
       "half of the length in contact below the bound of friction"},
      {"peak_pressure", &Outputs::peak_pressure, quantity,
       "largest pressure at a node, wherever it is"},
      {"centre_pressure", &Outputs::centre_pressure, quantity,
       "pressure at the middle of the curve, from a fit over the inner 12 % of the contact"},
      {"min_u", &Outputs::min_u, quantity, "smallest displacement of the whole field"},
      {"kkt_residual", &Outputs::kkt_residual, check,
       "residual of the problem that was solved, relative"},
      {"quadrature_residual", &Outputs::quadrature_residual, check,
       "Nitsche reduced: residual of the integrals over the whole curve"},
      {"max_penetration", &Outputs::max_penetration, check, "largest penetration at a node"},
      {"friction_violation", &Outputs::friction_violation, check,
       "largest tangential stress beyond its bound"},
      {"law_error_normal", &Outputs::law_error_normal, check,
       "Nitsche: |sigma_n - [P_n]_-| / |sigma_n| over the nodes (4.83)"},
      {"law_error_tangential", &Outputs::law_error_tangential, check,
       "Nitsche: |sigma_tau - [P_tau]_s| / |sigma_tau| over the nodes (4.92)"},
      {"law_error_tau_over_n", &Outputs::law_error_tau_over_n, check, "the same over |sigma_n|"},
      {"expected_error_u", &Outputs::expected_error_u, check,
       "largest error of u that verify measured, relative"},
      {"expected_error_lambda", &Outputs::expected_error_lambda, check,
       "largest error of the multipliers that verify measured, relative"},
      {"iterations", &Outputs::iterations, check, "steps of the solver"},
      {"seconds", &Outputs::seconds, check, "wall time of the answer"}};
  return columns;
}

void write_csv(std::ostream &out, const ParameterSpace &space, const std::vector<Mu> &mus,
               const std::vector<Outputs> &rows) {
  if (mus.size() != rows.size())
    throw failure("a table of " + std::to_string(mus.size()) + " parameters and " +
                  std::to_string(rows.size()) + " results");
  std::vector<OutputColumn> columns;
  for (const OutputColumn &column : output_columns())
    if (std::any_of(rows.begin(), rows.end(),
                    [&](const Outputs &row) { return (row.*column.value).has_value(); }))
      columns.push_back(column);

  for (int i = 0; i < space.size(); ++i)
    out << (i > 0 ? "," : "") << space.at(i).name;
  for (const OutputColumn &column : columns)
    out << ',' << column.name;
  out << '\n';
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t i = 0; i < mus[r].size(); ++i)
      out << (i > 0 ? "," : "") << exact_number(mus[r][i]);
    for (const OutputColumn &column : columns) {
      const std::optional<double> value = rows[r].*column.value;
      out << ',' << (value ? ten_digits(*value) : "");
    }
    out << '\n';
  }
}

void print_outputs(std::ostream &out, const Outputs &outputs) {
  for (const OutputColumn &column : output_columns())
    if (const std::optional<double> value = outputs.*column.value)
      out << std::left << std::setw(22) << column.name << ten_digits(*value) << '\n';
}

} // namespace rbvi
