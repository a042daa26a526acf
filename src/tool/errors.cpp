// What the answers of a model are off by, printed, in tables and in the model.
#include "verify.hpp"

#include "rbvi/core/output_units.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/io/output_table.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "rbvi/model/training_samples.hpp"
#include "rbvi/mor/cones.hpp"
#include "rbvi/mor/reduction.hpp"
#include "rbvi/study/output_errors.hpp"
#include "rbvi/tool/tables.hpp"

#include <algorithm>
#include <cstdio>
#include <iomanip>
#include <sstream>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

/// Errors of the ways to answer, by their names.
using Rows = std::vector<std::pair<std::string, ModelErrors>>;

constexpr const char *modes_alone = "modes alone";

/// The width of a column that holds all of these names, so that the numbers beside them stand below
/// each other.
int name_width(const Rows &rows) {
  std::size_t width = 18;
  for (const auto &[name, errors] : rows)
    width = std::max(width, name.size());
  return static_cast<int>(width);
}

void print_errors(const std::string &label, int width, const ModelErrors &e) {
  const char *name = label.c_str();
  if (e.failed > 0)
    std::printf("  %-*s no answer at %d of %d\n", width, name, e.failed,
                static_cast<int>(e.u.size()));
  else
    std::printf("  %-*s %9.2e %9.2e   %9.2e %9.2e   %9.3f   %9.1e\n", width, name, e.u.mean(),
                e.u.maxCoeff(), e.lambda.mean(), e.lambda.maxCoeff(), 1e3 * e.seconds,
                e.kkt_residual);
  if (e.failed == 0 && e.tangential.size() > 0)
    std::printf("  %-*s %9s %9s   %9.2e %9.2e\n", width, "  lambda_tau", "", "",
                e.tangential.mean(), e.tangential.maxCoeff());
}

/// The multiplier where it is worst (with friction its tangential part), and what it should be.
void write_worst_pressure(const fs::path &path, const ReducedModel &model, const Truths &truths,
                          const ModelErrors &errors) {
  const bool friction = errors.tangential.size() > 0;
  Index worst = 0;
  (friction ? errors.tangential : errors.lambda).maxCoeff(&worst);
  const Mu &mu = truths.mu[worst];
  OnlineSolver solver(model);
  const std::vector<Point> points = dual_points(solver.contact());
  const Matrix reduced = by_node(solver.contact(), solver.multiplier(solver.solve(mu, true))),
               truth = by_node(solver.contact(), truths.lambda.col(worst));
  Table table;
  table.add(model.scene.parameters, std::vector<Mu>(points.size(), mu));
  std::vector<double> interface;
  for (const auto &one : solver.contact().interfaces)
    interface.resize(interface.size() + static_cast<std::size_t>(one->dual().nodes()),
                     interface.empty() ? 1 : interface.back() + 1);
  table.add("interface", interface);
  for (std::size_t k = 0; k < static_cast<std::size_t>(solver.scene().dim); ++k) {
    std::vector<double> coordinates;
    for (const Point &x : points)
      coordinates.push_back(x[k]);
    table.add(std::string(1, static_cast<char>('x' + k)), coordinates);
  }
  table.add("high_fidelity", truth.col(0));
  table.add("reduced", reduced.col(0));
  if (friction) {
    const auto size = [&](const Matrix &of) -> Vector { // in the plane with its sign
      return of.cols() == 2 ? Vector(of.col(1)) : Vector(of.rightCols(2).rowwise().norm());
    };
    table.add("high_fidelity_tangential", size(truth));
    table.add("reduced_tangential", size(reduced));
  }
  table.write(path);
}

/// One row per way to answer; `with_outputs`: seconds of a query of the model with its outputs.
void write_summary(const fs::path &path, const Rows &rows, const ReducedModel &model,
                   double with_outputs) {
  std::ostringstream text;
  text << std::setprecision(10)
       << "model,N,S,R,free_modes,u_mean,u_max,u_floor_mean,u_floor_max,lambda_mean,lambda_max,"
          "lambda_floor_mean,lambda_floor_max,seconds,kkt_residual,failed,seconds_with_outputs\n";
  for (const auto &[name, e] : rows)
    text << name << ',' << model.body.modes << ','
         << (name == modes_alone ? 0 : model.body.supremizers) << ',' << model.contact.generators
         << ',' << model.contact.free_modes << ',' << e.u.mean() << ',' << e.u.maxCoeff() << ','
         << e.u_floor.mean() << ',' << e.u_floor.maxCoeff() << ',' << e.lambda.mean() << ','
         << e.lambda.maxCoeff() << ',' << e.lambda_floor.mean() << ',' << e.lambda_floor.maxCoeff()
         << ',' << e.seconds << ',' << e.kkt_residual << ',' << e.failed << ','
         << (name == rows.front().first ? shortest_number(with_outputs) : "nan") << '\n';
  write_atomically(path, text.str());
}

void write_errors(const fs::path &path, const ParameterSpace &space, const Truths &truths,
                  const Rows &rows) {
  const ModelErrors &enriched = rows.front().second, &plain = rows.back().second;
  Table table;
  table.add(space, truths.mu);
  table.add("u_enriched", enriched.u);
  table.add("lambda_enriched", enriched.lambda);
  table.add("u_decorrelated", plain.u);
  table.add("lambda_decorrelated", plain.lambda);
  if (enriched.tangential.size() > 0) {
    table.add("tangential_enriched", enriched.tangential);
    table.add("tangential_decorrelated", plain.tangential);
  }
  table.add("u_floor", enriched.u_floor);
  table.add("lambda_floor", enriched.lambda_floor);
  table.write(path);
}

std::string reduction_name(const NodalLaw &law) {
  return multiplier_reduction_names()[static_cast<std::size_t>(law.reduction)];
}

const char *kind_name(OutputKind kind) {
  return kind == OutputKind::quantity  ? "quantity"
         : kind == OutputKind::measure ? "measure"
                                       : "check";
}

/// Every output: its definition's kind, absolute errors, and errors over its range and its value.
void write_output_errors(const fs::path &path, const Scene &scene,
                         const std::vector<OutputError> &errors) {
  std::ostringstream text;
  text << std::setprecision(4)
       << "output,kind,mean,max,mean_of_range,max_of_range,mean_of_value,max_of_value,unit\n";
  for (const OutputError &e : errors)
    text << e.name << ',' << kind_name(output_column(e.name).kind) << ',' << e.mean << ',' << e.max
         << ',' << e.mean_of_range << ',' << e.max_of_range << ',' << e.mean_of_value << ','
         << e.max_of_value << ',' << unit_of(scene, output_column(e.name)) << '\n';
  write_atomically(path, text.str());
}

/// Errors of the outputs that have a target: quantities and measures.
void print_output_errors(const std::vector<OutputError> &errors) {
  for (const OutputError &e : errors)
    if (output_column(e.name).kind != OutputKind::check)
      std::printf("  %-20s %9.1e %9.1e %9.1e\n", e.name.c_str(), e.max, e.max_of_range,
                  e.max_of_value);
}

std::string name_of(const ReducedModel &model) {
  return !model.has_multipliers()      ? nitsche_name(model)
         : model.contact.law           ? reduction_name(*model.contact.law)
         : model.body.supremizers == 0 ? modes_alone
         : model.body.online_enriched  ? "supremizers made online"
                                       : "supremizers made offline";
}

/// Of the model, and of its modes alone where it has more.
Rows rows_of(const ReducedModel &model, const Truths &truths, const SparseMatrix &w) {
  Rows rows{{name_of(model), model_errors(model, {}, truths, w)}};
  if (model.body.supremizers > 0)
    rows.emplace_back(
        modes_alone,
        model_errors(leading(model, model.body.modes, model.contact.generators), {}, truths, w));
  return rows;
}

void print_rows(const std::string &where, const Rows &rows) {
  const int width = name_width(rows);
  std::printf("Relative errors %s\n  %-*s %9s %9s   %9s %9s   %9s   %9s\n", where.c_str(), width,
              "", "u mean", "max", "lambda m.", "max", "ms/query", "KKT");
  for (const auto &[label, errors] : rows)
    print_errors(label, width, errors);
  const ModelErrors &whole = rows.front().second;
  std::printf("  %-*s %9.2e %9.2e   %9.2e %9.2e\n", width, "best of the bases",
              whole.u_floor.mean(), whole.u_floor.maxCoeff(), whole.lambda_floor.mean(),
              whole.lambda_floor.maxCoeff());
  if (whole.tangential_floor.size() > 0)
    std::printf("  %-*s %9s %9s   %9.2e %9.2e\n", width, "  lambda_tau", "", "",
                whole.tangential_floor.mean(), whole.tangential_floor.maxCoeff());
}

/// The reduced outputs at the validation mu into a table, and the errors of these and of those on
/// the boundary of the box.
std::vector<OutputError> check_outputs(const ReducedModel &model, const Truths &validation,
                                       const Truths &boundary, const std::vector<std::string> &only,
                                       const fs::path &out) {
  std::vector<Outputs> reduced = reduced_outputs(model, validation.mu, only),
                       truths = validation.outputs;
  std::ostringstream table;
  write_csv(table, model.scene.parameters, validation.mu, reduced);
  write_atomically(out / "reduced.csv", table.str());
  const std::vector<Outputs> further = reduced_outputs(model, boundary.mu, only);
  reduced.insert(reduced.end(), further.begin(), further.end());
  truths.insert(truths.end(), boundary.outputs.begin(), boundary.outputs.end());
  std::vector<OutputError> errors = output_errors(reduced, truths);
  std::printf("Errors of the outputs, largest over all %zu: absolute, over the range, over the "
              "value\n",
              reduced.size());
  print_output_errors(errors);
  write_output_errors(out / "outputs.csv", model.scene, errors);
  return errors;
}

} // namespace

double check_errors(ReducedModel &model, const SparseMatrix &w, const Truths &validation,
                    const Truths &boundary, const std::vector<std::string> &only,
                    const fs::path &out) {
  const Rows rows = rows_of(model, validation, w);
  print_rows("over " + std::to_string(validation.mu.size()) + " validation mu", rows);
  write_errors(out / "errors.csv", model.scene.parameters, validation, rows);
  const double with_outputs = seconds_with_outputs(model, validation.mu, only);
  std::printf("  %-*s %9s %9s   %9s %9s   %9.3f\n", name_width(rows),
              only.empty() ? "with its outputs" : "with those asked", "", "", "", "",
              1e3 * with_outputs);
  write_summary(out / "summary.csv", rows, model, with_outputs);
  if (rows.front().second.failed == 0)
    write_worst_pressure(out / "worst_pressure.csv", model, validation, rows.front().second);
  Rows at_boundary;
  fs::remove(out / "errors_at_boundary.csv");
  if (!boundary.mu.empty()) {
    at_boundary = rows_of(model, boundary, w);
    print_rows("at " + std::to_string(boundary.mu.size()) + " corners and centres of faces",
               at_boundary);
    write_errors(out / "errors_at_boundary.csv", model.scene.parameters, boundary, at_boundary);
  }
  const auto summary_of = [&](std::size_t k) {
    std::vector<const ModelErrors *> sets{&rows[k].second};
    if (!at_boundary.empty()) sets.push_back(&at_boundary[k].second);
    return summary(sets);
  };
  model.made.validation_enriched = model.body.supremizers > 0 ? summary_of(0) : ValidationErrors{};
  model.made.validation_decorrelated = summary_of(rows.size() - 1);
  (model.body.supremizers > 0 ? model.made.validation_enriched : model.made.validation_decorrelated)
      .outputs = check_outputs(model, validation, boundary, only, out);
  std::vector<Mu> all = validation.mu;
  all.insert(all.end(), boundary.mu.begin(), boundary.mu.end());
  model.made.validated_mu = as_columns(all, model.scene.parameters.size());
  return with_outputs;
}

} // namespace rbvi
