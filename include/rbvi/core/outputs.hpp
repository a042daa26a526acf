// The quantities of interest of one solve, full or reduced, and their table. Niakh (2022): (4.14).
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/parameters.hpp"

#include <array>
#include <map>
#include <optional>
#include <ostream>
#include <vector>

namespace rbvi {

struct NamedOutput {
  std::string name;
  double value; ///< NaN: it has none here, such as a mean over nothing
};

/// A quantity that a scene does not have stays unset and has no column.
struct Outputs {
  std::optional<double> energy;       ///< J(u) = a(u,u)/2 - f(u)
  std::optional<double> normal_force; ///< integral of the multiplier
  std::optional<double> tangential_force, reaction, horizontal_reaction;
  std::optional<double> force_x, force_y, force_z; ///< of contact on the body, in space
  /// Sum of the lumped weights of the active nodes; of an obstacle by vertex quadrature,
  /// contact_area.
  std::optional<double> contact_measure;
  std::optional<double> contact_half_width, stick_half_width;
  std::optional<double> peak_pressure, centre_pressure;
  /// Nodes (or macro-edges of a pair) with pressure, and those of them below the bound of friction:
  /// how well the mesh resolves the two zones.
  std::optional<double> contact_nodes, stick_nodes;
  /// Ends of the contact boundary (of a region nodes on its rim) that carry pressure, beside which
  /// the body goes on.
  std::optional<double> ends_in_contact;
  /// For resolution_warning alone, without columns: nodes without pressure, and the number of
  /// directions, along the curve or against it, that the tangential stress has in contact.
  std::optional<double> free_nodes, slip_directions;
  /// Likewise: max_penetration where it is beyond the round-off of the gaps.
  std::optional<double> overlap;
  /// Likewise, of small kinematics (validity_warning): how far gaps where bodies touch are from
  /// those between the deformed bodies, over the largest approach; the share of the body where a
  /// strain or a rotation is above large_strain.
  std::optional<double> gap_error, strained;
  /// Likewise: nodes that imposed values hold below the surface, where there is no multiplier, and
  /// how deep.
  std::optional<double> held_nodes, held_depth;
  std::optional<double> min_u;
  /// Residual of the problem that was solved, relative: stationarity, feasibility, complementarity;
  /// of a reduced answer that of the reduced problem, by Nitsche's method that of its equation.
  std::optional<double> kkt_residual;
  /// Nitsche's method reduced: residual of the integrals over the whole curve, tested with the
  /// reduced basis; what integrating at few points leaves.
  std::optional<double> quadrature_residual;
  std::optional<double> max_penetration; ///< pointwise at the nodes of the contact region
  std::optional<double> friction_violation;
  /// Nitsche's method: e_AC^n (4.83), and e_AC^ntau (4.92) over the norm of the tangential stress
  /// and of the normal one.
  std::optional<double> law_error_normal, law_error_tangential, law_error_tau_over_n;
  /// Largest relative errors of the reduced model over its validation set (not of this answer).
  std::optional<double> expected_error_u, expected_error_lambda;
  /// Of this reduced answer, |u - u_N| and |B^T (lambda - lambda_N)| at most, over |u_N|, all in
  /// the energy norm; an indicator where friction follows the pressure; |u_N| itself.
  std::optional<double> error_bound, error_indicator, energy_norm;
  std::optional<double> iterations;
  /// Large deformations: load steps that the answer took, where steps from its start failed; else
  /// 0.
  std::optional<double> load_steps;
  /// Large deformations: the change in the last step over that in the one before.
  std::optional<double> contraction;
  std::optional<double> seconds;
  /// Of the scene's own (Scene::outputs), in their order; behind them what a reduced answer alone
  /// tells, intervals (NAME_lower, NAME_upper) and derivatives.
  std::vector<NamedOutput> named{};
  std::string name{};                ///< of the contact interface, where they are of one alone
  std::vector<Outputs> interfaces{}; ///< of contact, each apart; empty: there is one
};

/// Every number of Outputs but the named ones, in the order of the table in outputs.cpp, which
/// knows of each its column, what several contacts make of it, and its definition.
std::vector<std::optional<double>> numbers_of(const Outputs &outputs);
/// The inverse. Throws bad_input for another number of them.
void set_numbers(const std::vector<std::optional<double>> &numbers, Outputs &outputs);

/// Adds the outputs of a further contact interface: itself, sums of forces and measures, the
/// largest of pressures and errors; the others stay as they are.
void add_contact(const Outputs &one, Outputs &all);

/// What an output is, which tells how accurate a reduced one must be.
enum class OutputKind {
  quantity, ///< energy, forces, pressures, displacements: as accurate as the fields
  measure,  ///< counted along the contact: to one edge of the mesh
  check     ///< residuals, violations, iterations, seconds: of the answer itself
};

/// `none`: a number without a unit; area: of contact.
enum class Size { none, energy, force, area, length, pressure };

struct OutputColumn {
  std::string name;
  std::optional<double> Outputs::*value; ///< null: one of Outputs::named
  OutputKind kind;
  const char *says;       ///< its definition, one line
  Size size = Size::none; ///< of a named output core/output_units.hpp knows its unit
  /// Unset where the answer has no such value.
  std::optional<double> of(const Outputs &outputs) const;
};

/// All columns but those of named outputs, in the order of every table.
const std::vector<OutputColumn> &output_columns();
/// The columns that some of these answers have; named outputs stand last.
std::vector<OutputColumn> columns_of(const std::vector<Outputs> &rows);

/// The one of this name; of none that is known that of a named output.
OutputColumn output_column(const std::string &name);

/// What bounds of errors tell.
const std::vector<std::string> &names_of_bounds();
/// The interval that an output is in, where the answer has outputs NAME_lower and NAME_upper.
inline std::optional<std::array<double, 2>> interval_of(const Outputs &outputs,
                                                        const std::string &name) {
  const std::optional<double> lower = output_column(name + "_lower").of(outputs),
                              upper = output_column(name + "_upper").of(outputs);
  if (!lower || !upper) return std::nullopt;
  return std::array{*lower, *upper};
}

/// Whether an output is one of those that are asked for; `only` empty: all are.
bool is_asked(const std::vector<std::string> &only, const std::string &name);
/// The numbers that are asked for, of all contacts together, and all named outputs.
Outputs asked_of(Outputs outputs, const std::vector<std::string> &only);

/// Measured errors of outputs by column name, absolute.
using ErrorOfOutput = std::map<std::string, double>;

/// "name value" lines for one answer, with "(largest error ...)" where one was measured, and a line
/// for each of several contact interfaces.
void print_outputs(std::ostream &out, const Outputs &outputs, const ErrorOfOutput &errors = {});

/// The largest penetration at nodes, and of what it is made: gaps without displacement and
/// displacements along them. `left`: the gaps that are left, infinite where they are not known.
std::array<double, 2> penetration_at(const Vector &left, const Vector &gaps);
/// Sets max_penetration and overlap from the largest of both.
void set_penetration(const std::array<double, 2> &penetration, Outputs &outputs);

/// Throws failure, naming it, where an output is not finite, unless it has no value.
void check_finite(const Outputs &outputs);

/// Whether a table of rbvi can have a column of this name beside the parameters.
bool is_table_column(const std::string &name);

} // namespace rbvi
