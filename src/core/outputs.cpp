#include "rbvi/core/outputs.hpp"

#include "rbvi/core/error.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <iomanip>

namespace rbvi {

namespace {

struct Column {
  const char *name;
  std::optional<double> Outputs::*value;
};

constexpr Column all_columns[] = {
    {"energy", &Outputs::energy},
    {"normal_force", &Outputs::normal_force},
    {"tangential_force", &Outputs::tangential_force},
    {"reaction", &Outputs::reaction},
    {"contact_measure", &Outputs::contact_measure},
    {"contact_half_width", &Outputs::contact_half_width},
    {"stick_half_width", &Outputs::stick_half_width},
    {"peak_pressure", &Outputs::peak_pressure},
    {"centre_pressure", &Outputs::centre_pressure},
    {"min_u", &Outputs::min_u},
    {"kkt_residual", &Outputs::kkt_residual},
    {"max_penetration", &Outputs::max_penetration},
    {"friction_violation", &Outputs::friction_violation},
    {"law_error_normal", &Outputs::law_error_normal},
    {"law_error_tangential", &Outputs::law_error_tangential},
    {"law_error_tau_over_n", &Outputs::law_error_tau_over_n},
    {"expected_error_u", &Outputs::expected_error_u},
    {"expected_error_lambda", &Outputs::expected_error_lambda},
    {"iterations", &Outputs::iterations},
    {"seconds", &Outputs::seconds},
};

std::string ten_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

/// The shortest text that reads back as the same number.
std::string exact(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

} // namespace

void write_csv(std::ostream &out, const ParameterSpace &space, const std::vector<Mu> &mus,
               const std::vector<Outputs> &rows) {
  if (mus.size() != rows.size())
    throw failure("a table of " + std::to_string(mus.size()) + " parameters and " +
                  std::to_string(rows.size()) + " results");
  std::vector<Column> columns;
  for (const Column &column : all_columns)
    if (std::any_of(rows.begin(), rows.end(),
                    [&](const Outputs &row) { return (row.*column.value).has_value(); }))
      columns.push_back(column);

  for (int i = 0; i < space.size(); ++i)
    out << (i > 0 ? "," : "") << space.at(i).name;
  for (const Column &column : columns)
    out << ',' << column.name;
  out << '\n';
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t i = 0; i < mus[r].size(); ++i)
      out << (i > 0 ? "," : "") << exact(mus[r][i]);
    for (const Column &column : columns) {
      const std::optional<double> value = rows[r].*column.value;
      out << ',' << (value ? ten_digits(*value) : "");
    }
    out << '\n';
  }
}

void print_outputs(std::ostream &out, const Outputs &outputs) {
  for (const Column &column : all_columns)
    if (const std::optional<double> value = outputs.*column.value)
      out << std::left << std::setw(22) << column.name << ten_digits(*value) << '\n';
}

} // namespace rbvi
