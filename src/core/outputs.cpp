#include "rbvi/core/outputs.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/formula.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>

namespace rbvi {

const std::vector<std::string> &output_fields() {
  static const std::vector<std::string> names{"x",          "y",
                                              "z",          "ux",
                                              "uy",         "uz",
                                              "pressure",   "gap",
                                              "tangential", "slip",
                                              "u",          "nx",
                                              "ny",         "nz",
                                              "sigma_xx",   "sigma_yy",
                                              "sigma_zz",   "sigma_xy",
                                              "sigma_yz",   "sigma_xz",
                                              "von_mises",  "strain_energy",
                                              "contact",    "stick",
                                              "slope_x",    "slope_y"};
  return names;
}

namespace {

/// What several contacts make of it together.
enum class OfContacts { none, sum, largest };

/// A number of Outputs (null: one of the named), its column ("": it has none), what it is, its
/// definition, its unit.
struct OutputRow {
  std::optional<double> Outputs::*value;
  const char *column;
  OutputKind kind;
  OfContacts together;
  const char *says;
  Size size = Size::none;
};

const std::vector<OutputRow> &output_rows() {
  using enum OutputKind;
  using enum OfContacts;
  static const std::vector<OutputRow> rows{
      {&Outputs::energy, "energy", quantity, none, "J(u) = a(u, u) / 2 - f(u)", Size::energy},
      {&Outputs::normal_force, "normal_force", quantity, sum, "integral of the contact pressure",
       Size::force},
      {&Outputs::tangential_force, "tangential_force", quantity, sum,
       "integral of the magnitude of the tangential stress", Size::force},
      {&Outputs::reaction, "reaction", quantity, sum,
       "vertical force of contact on the (first) body", Size::force},
      {&Outputs::horizontal_reaction, "horizontal_reaction", quantity, sum,
       "horizontal force of contact on the (first) body, to the right", Size::force},
      {&Outputs::force_x, "force_x", quantity, sum,
       "force of contact on the body along x (in space)", Size::force},
      {&Outputs::force_y, "force_y", quantity, sum, "likewise along y", Size::force},
      {&Outputs::force_z, "force_z", quantity, sum, "likewise along z", Size::force},
      {&Outputs::contact_measure, "contact_measure", measure, sum,
       "length or area in contact: weights of the nodes with pressure (of the membrane with "
       "-lumped each by its pressure over the largest beside it)",
       Size::area},
      {&Outputs::contact_half_width, "contact_half_width", measure, none, "half of contact_measure",
       Size::length},
      {&Outputs::stick_half_width, "stick_half_width", measure, none,
       "half of the length in contact below the bound of friction", Size::length},
      {&Outputs::peak_pressure, "peak_pressure", quantity, largest,
       "largest pressure at a node, wherever it is", Size::pressure},
      {&Outputs::centre_pressure, "centre_pressure", quantity, none,
       "pressure at the middle of a curve in one open piece, from a fit over the inner 12 % of the "
       "contact",
       Size::pressure},
      {&Outputs::min_u, "min_u", quantity, none, "smallest displacement of the whole field",
       Size::length},
      {&Outputs::contact_nodes, "contact_nodes", check, sum,
       "nodes (-multiplier p0: pairs of edges) with pressure"},
      {&Outputs::stick_nodes, "stick_nodes", check, sum, "those below the bound of friction"},
      {&Outputs::ends_in_contact, "ends_in_contact", check, sum,
       "ends of the contact boundary, beyond which the body goes on, with pressure (of a membrane "
       "the nodes on the rim of its region)"},
      {&Outputs::kkt_residual, "kkt_residual", check, none,
       "residual of the problem that was solved, relative"},
      {&Outputs::quadrature_residual, "quadrature_residual", check, none,
       "Nitsche reduced: residual of the integrals over the whole curve"},
      {&Outputs::max_penetration, "max_penetration", check, largest,
       "largest penetration at a node, held or not", Size::length},
      {&Outputs::friction_violation, "friction_violation", check, largest,
       "largest tangential stress beyond its bound", Size::pressure},
      {&Outputs::law_error_normal, "law_error_normal", check, none,
       "Nitsche: |sigma_n - [P_n]_-| / |sigma_n| over the nodes of all curves (4.83)"},
      {&Outputs::law_error_tangential, "law_error_tangential", check, none,
       "Nitsche: |sigma_tau - [P_tau]_s| / |sigma_tau| over the nodes (4.92)"},
      {&Outputs::law_error_tau_over_n, "law_error_tau_over_n", check, none,
       "the same over |sigma_n|"},
      {&Outputs::expected_error_u, "expected_error_u", check, none,
       "largest error of u that verify measured, relative"},
      {&Outputs::expected_error_lambda, "expected_error_lambda", check, none,
       "largest error of the multipliers that verify measured, relative"},
      {&Outputs::error_bound, "error_bound", check, none,
       "|u - u_N| and |B^T (lambda - lambda_N)| of this answer over energy_norm are at most this"},
      {&Outputs::error_indicator, "error_indicator", check, none, "the same as an estimate"},
      {&Outputs::energy_norm, "energy_norm", check, none, "|u_N| in the energy norm"},
      {nullptr, "energy_lower", check, none,
       "without friction: the energy of the high-fidelity answer is at least this", Size::energy},
      {nullptr, "energy_upper", check, none, "and at most this", Size::energy},
      {nullptr, "normal_force_lower", check, none, "likewise normal_force is at least this",
       Size::force},
      {nullptr, "normal_force_upper", check, none, "and at most this", Size::force},
      {nullptr, "reaction_lower", check, none, "likewise reaction is at least this", Size::force},
      {nullptr, "reaction_upper", check, none, "and at most this", Size::force},
      {&Outputs::iterations, "iterations", check, none, "steps of the solver"},
      {&Outputs::load_steps, "load_steps", check, none,
       "large deformations: load steps, where steps from the start failed; else 0"},
      {&Outputs::contraction, "contraction", check, none,
       "large deformations: change in the last step over that in the one before"},
      {&Outputs::seconds, "seconds", check, none, "wall time of the answer"},
      {&Outputs::free_nodes, "", check, sum, ""},
      {&Outputs::slip_directions, "", check, largest, ""},
      {&Outputs::overlap, "", check, none, ""},
      {&Outputs::gap_error, "", check, none, ""},
      {&Outputs::strained, "", check, none, ""},
      {&Outputs::held_nodes, "", check, sum, ""},
      {&Outputs::held_depth, "", check, largest, ""}};
  return rows;
}

} // namespace

const std::vector<OutputColumn> &output_columns() {
  static const std::vector<OutputColumn> columns = [] {
    std::vector<OutputColumn> result;
    for (const OutputRow &row : output_rows())
      if (*row.column != 0) result.push_back({row.column, row.value, row.kind, row.says, row.size});
    return result;
  }();
  return columns;
}

std::vector<std::optional<double>> numbers_of(const Outputs &outputs) {
  std::vector<std::optional<double>> numbers;
  for (const OutputRow &row : output_rows())
    if (row.value != nullptr) numbers.push_back(outputs.*row.value);
  return numbers;
}

void set_numbers(const std::vector<std::optional<double>> &numbers, Outputs &outputs) {
  if (numbers.size() != numbers_of(outputs).size()) throw bad_input("another number of outputs");
  auto number = numbers.begin();
  for (const OutputRow &row : output_rows())
    if (row.value != nullptr) outputs.*row.value = *number++;
}

void add_contact(const Outputs &one, Outputs &all) {
  for (const OutputRow &row : output_rows()) {
    if (row.together == OfContacts::none) continue;
    std::optional<double> &total = all.*row.value;
    if (const std::optional<double> &more = one.*row.value)
      total = !total                            ? *more
              : row.together == OfContacts::sum ? *total + *more
                                                : std::max(*total, *more);
  }
  all.interfaces.push_back(one);
}

std::array<double, 2> penetration_at(const Vector &left, const Vector &gaps) {
  double deepest = 0, size = 0;
  for (Index node = 0; node < left.size(); ++node) {
    if (left[node] == std::numeric_limits<double>::infinity()) continue;
    deepest = larger(deepest, -left[node]);
    size = std::max({size, std::abs(gaps[node]), std::abs(gaps[node] - left[node])});
  }
  return {deepest, size};
}

void set_penetration(const std::array<double, 2> &penetration, Outputs &outputs) {
  constexpr double round_off = 1e-10;
  const auto [deepest, size] = penetration;
  outputs.max_penetration = deepest;
  if (deepest > round_off * size) outputs.overlap = deepest;
}

void print_outputs(std::ostream &out, const Outputs &outputs, const ErrorOfOutput &errors) {
  for (const OutputColumn &column : columns_of({outputs})) {
    const std::optional<double> value = column.of(outputs);
    const std::string digits = value ? formatted("%.10g", *value) : "(no value)";
    out << std::left << std::setw(21) << column.name << ' ' << digits;
    const auto error = errors.find(column.name);
    if (error != errors.end())
      out << std::setw(static_cast<int>(18 - digits.size())) << ""
          << "(largest error " << formatted("%.1e", error->second) << ')';
    out << '\n';
  }
  for (const Outputs &one : outputs.interfaces) {
    out << one.name << ':';
    for (const char *name : {"normal_force", "tangential_force", "contact_measure", "peak_pressure",
                             "contact_nodes", "stick_nodes"})
      if (const std::optional<double> value = output_column(name).of(one))
        out << ' ' << name << ' ' << formatted("%.10g", *value);
    out << '\n';
  }
}

void check_finite(const Outputs &outputs) {
  for (const OutputColumn &column : columns_of({outputs}))
    if (const std::optional<double> value = column.of(outputs); value && !std::isfinite(*value))
      throw failure("the answer has no " + column.name + ", which is " + short_number(*value) +
                    ": is a load, a material or the mesh extreme, or a function of the scene not "
                    "finite there?");
}

std::optional<double> OutputColumn::of(const Outputs &outputs) const {
  if (value != nullptr) return outputs.*value;
  const auto found = std::ranges::find(outputs.named, name, &NamedOutput::name);
  return found == outputs.named.end() || std::isnan(found->value) ? std::optional<double>()
                                                                  : found->value;
}

std::vector<OutputColumn> columns_of(const std::vector<Outputs> &rows) {
  std::vector<OutputColumn> columns;
  for (const OutputColumn &column : output_columns())
    if (std::ranges::any_of(rows, [&](const Outputs &row) { return column.of(row).has_value(); }))
      columns.push_back(column);
  for (const Outputs &row : rows)
    for (const NamedOutput &named : row.named)
      if (std::ranges::find(columns, named.name, &OutputColumn::name) == columns.end())
        columns.push_back(output_column(named.name));
  return columns;
}

OutputColumn output_column(const std::string &name) {
  const auto found = std::ranges::find(output_columns(), name, &OutputColumn::name);
  return found != output_columns().end()
             ? *found
             : OutputColumn{name, nullptr, OutputKind::quantity, "of the case", Size::none};
}

const std::vector<std::string> &names_of_bounds() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> result{"error_bound", "error_indicator", "energy_norm"};
    for (const OutputRow &row : output_rows())
      if (row.value == nullptr) result.emplace_back(row.column);
    return result;
  }();
  return names;
}

bool is_asked(const std::vector<std::string> &only, const std::string &name) {
  return only.empty() || std::ranges::find(only, name) != only.end();
}

Outputs asked_of(Outputs outputs, const std::vector<std::string> &only) {
  for (const OutputColumn &column : output_columns())
    if (column.value != nullptr && !is_asked(only, column.name))
      outputs.*column.value = std::nullopt;
  if (!only.empty()) outputs.interfaces.clear();
  return outputs;
}

bool is_table_column(const std::string &name) {
  static const std::vector<std::string> others =
      split("id status training max_aspect_ratio u_enriched u_floor lambda_floor lambda_enriched "
            "tangential_enriched u_decorrelated lambda_decorrelated tangential_decorrelated "
            "beta_hf beta_on beta_off beta_dec",
            ' ');
  if (std::ranges::find(others, name) != others.end()) return true;
  return std::any_of(output_columns().begin(), output_columns().end(),
                     [&](const OutputColumn &column) {
                       return name == column.name || name == column.name + "_error";
                     });
}

} // namespace rbvi
