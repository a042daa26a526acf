#include "online_batch.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/output_units.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/io/output_table.hpp"
#include "rbvi/model/training_samples.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

std::string json_text(const std::string &text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return result + '"';
}

/// "name": value, of a number that is none null.
std::string json_member(const std::string &name, double value) {
  return json_text(name) + ": " + (std::isfinite(value) ? shortest_number(value) : "null");
}

/// The place and the fields of the nodes of a contact, vectors by component.
std::vector<Field> columns_at(const Grid &grid, Index dim) {
  constexpr std::array axes{"x", "y", "z"};
  const Index nodes = grid.points.rows();
  std::vector<Field> columns;
  for (Index k = 0; k < dim; ++k)
    columns.push_back({axes[k], grid.points.col(k)});
  for (const Field &field : grid.of_nodes) {
    const Index each = nodes > 0 ? field.values.size() / nodes : 0;
    for (Index k = 0; k < std::min(each, dim); ++k)
      columns.push_back({each == 1 ? field.name : field.name + "_" + axes[k],
                         field.values(Eigen::seqN(k, nodes, each))});
  }
  return columns;
}

} // namespace

std::string json_of(const OnlineSolver &solver, const Mu &mu, const ReducedAnswer &solution,
                    const Outputs &outputs, const ErrorOfOutput &errors,
                    const std::string &warnings) {
  const ParameterSpace &space = solver.scene().parameters;
  std::vector<std::string> parameters, values, lines;
  for (int i = 0; i < space.size(); ++i)
    parameters.push_back(json_text(space.at(i).name) + ": {" + json_member("value", mu[i]) +
                         ", \"unit\": " + json_text(space.at(i).unit) + "}");
  for (const OutputColumn &column : columns_of({outputs})) {
    const double value = column.of(outputs).value_or(std::nan(""));
    const auto error = errors.find(column.name);
    values.push_back(
        json_text(column.name) + ": {" + json_member("value", value) +
        ", \"unit\": " + json_text(unit_of(solver.scene(), column)) +
        (error == errors.end() ? "}" : ", " + json_member("expected_error", error->second) + "}"));
  }
  std::istringstream all(warnings);
  for (std::string line; std::getline(all, line);)
    lines.push_back(json_text(line));
  return "{\"parameters\": {" + joined(parameters) + "}, \"outputs\": {" + joined(values) + "}, " +
         json_member("residual", solution.residual) +
         ", \"inside\": " + (in_box(space, mu) ? "true, " : "false, ") +
         json_member("to_other", solution.to_other) + ", \"warnings\": [" + joined(lines) + "]}\n";
}

TraceTable::TraceTable(OnlineSolver &solver, int digits)
    : format_(",%." + std::to_string(digits) + "g") {
  (void)example_outputs(solver.model(), [&](const Mu &mu) {
    columns_.clear();
    const ReducedAnswer solution = solver.solve(mu);
    for (std::size_t i = 0; i < solver.contact().interfaces.size(); ++i) {
      const Grid grid = solver.contact_grid(solution, i);
      if (grid.points.rows() == 0) throw failure("a contact faces nothing");
      for (const Field &column : columns_at(grid, solver.scene().dim))
        if (std::ranges::count(columns_, column.name) == 0) columns_.push_back(column.name);
    }
    return Outputs{};
  });
}

std::string TraceTable::header() const {
  return "row,contact," + joined(columns_, ",") + "\n";
}

std::string TraceTable::rows(const OnlineSolver &solver, const ReducedAnswer &solution,
                             long row) const {
  std::string text;
  for (std::size_t i = 0; i < solver.contact().interfaces.size(); ++i) {
    const Grid grid = solver.contact_grid(solution, i);
    const std::vector<Field> columns = columns_at(grid, solver.scene().dim);
    for (Index node = 0; node < grid.points.rows(); ++node) {
      text += std::to_string(row) + "," + csv_quoted(contact_name(solver.scene(), i));
      for (const std::string &name : columns_) {
        const auto column = std::ranges::find(columns, name, &Field::name);
        const bool has = column != columns.end() && std::isfinite(column->values[node]);
        text += has ? formatted(format_.c_str(), column->values[node]) : ",";
      }
      text += '\n';
    }
  }
  return text;
}

} // namespace rbvi
