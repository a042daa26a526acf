// rbvi compare: errors, sizes and times of models that were verified, side by side.
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/io/output_table.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "rbvi/model/model.hpp"
#include "rbvi/model/print.hpp"
#include "rbvi/tool/commands.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

/// What is known of a run, by the names of rows, in their order.
struct Run {
  std::string name;
  std::vector<std::pair<std::string, std::string>> values{};
  void add(const std::string &row, const std::string &value) { values.emplace_back(row, value); }
  std::string at(const std::string &row) const {
    const auto found = std::ranges::find(values, row, &std::pair<std::string, std::string>::first);
    return found == values.end() ? "" : found->second;
  }
};

/// Of a query with its outputs, in milliseconds; "" where no table of verify is beside the model.
std::string query_time(const fs::path &folder) {
  std::ifstream table(folder / "verify" / "summary.csv");
  std::string header, row;
  if (!std::getline(table, header) || !std::getline(table, row)) return "";
  const std::vector<std::string> names = csv_fields(header), values = csv_fields(row);
  const auto at = std::ranges::find(names, "seconds_with_outputs") - names.begin();
  if (at >= std::ssize(values)) return "";
  return short_number(1e3 * parse_number(values[at], "seconds_with_outputs"));
}

/// Of a run folder; what is none is a model file.
fs::path model_of(const std::string &given) {
  return fs::is_directory(given) ? fs::path(given) / "model.h5" : fs::path(given);
}

/// Throws bad_input where there is no model, or none that was verified.
Run run_of(const std::string &given, const Registry &registry) {
  const fs::path file = model_of(given);
  Run run{given.substr(0, given.find_last_not_of('/') + 1)};
  if (file != given && !fs::exists(file))
    throw bad_input(run.name + " has no model: rbvi offline -out " + run.name + " makes it");
  const ReducedModel model = read_model(file, registry, false);
  const ValidationErrors &errors = expected_errors(model);
  if (errors.count + errors.unanswered == 0)
    throw bad_input(run.name + " was not verified: rbvi verify -out " +
                    file.parent_path().string() + " measures its errors");
  const auto error = [](double value) { return value < 0 ? "" : formatted("%.1e", value); };
  run.add("scene", model.scene.name);
  run.add("training samples", std::to_string(model.made.trained_mu.cols()));
  run.add("functions of u", std::to_string(model.primal_size()));
  run.add("of the multipliers", std::to_string(model.contact.generators));
  run.add("error of u", error(errors.u_max));
  run.add("error of multipliers", error(std::max(errors.lambda_max, errors.tangential_max)));
  for (const OutputError &output : errors.outputs)
    if (output_column(output.name).kind != OutputKind::check)
      run.add("error of " + output.name, error(output.max_of_range));
  run.add("without an answer", std::to_string(errors.unanswered));
  run.add("ms/query", query_time(file.parent_path()));
  double offline = 0;
  for (const auto &[stage, seconds] : model.made.stage_seconds)
    offline += seconds;
  run.add("offline s", formatted("%.3g", offline));
  run.add("model MB", formatted("%.3g", static_cast<double>(fs::file_size(file)) / 1e6));
  return run;
}

/// The rows that some run has, each behind the one that it follows there.
std::vector<std::string> rows_of(const std::vector<Run> &runs) {
  std::vector<std::string> rows;
  for (const Run &run : runs) {
    auto at = rows.begin();
    for (const auto &[row, value] : run.values) {
      const auto found = std::ranges::find(rows, row);
      at = (found == rows.end() ? rows.insert(at, row) : found) + 1;
    }
  }
  return rows;
}

std::string csv_of(const std::vector<Run> &runs, const std::vector<std::string> &rows) {
  std::string table = "run";
  for (const std::string &row : rows)
    table += "," + row;
  for (const Run &run : runs) {
    table += "\n" + csv_quoted(run.name);
    for (const std::string &row : rows)
      table += "," + run.at(row);
  }
  return table + "\n";
}

} // namespace

void command_compare(const std::vector<std::string> &given, const std::string &csv,
                     const Registry &registry) {
  std::vector<Run> runs;
  for (const std::string &run : given) {
    runs.push_back(run_of(run, registry));
    check_overwriting({"-csv", csv}, {{"the model", model_of(run)}});
  }
  const std::vector<std::string> rows = rows_of(runs);
  std::size_t width = 12;
  for (const Run &run : runs)
    width = std::max({width, run.name.size(), run.at("scene").size()});
  const auto print = [&](const std::string &row, const auto &value) {
    std::printf("%-30s", row.c_str());
    for (const Run &run : runs)
      std::printf("  %*s", static_cast<int>(width), value(run).c_str());
    std::printf("\n");
  };
  print("", [](const Run &run) { return run.name; });
  for (const std::string &row : rows)
    print(row, [&](const Run &run) { return run.at(row); });
  if (csv.empty()) return;
  write_atomically(csv, csv_of(runs, rows));
  print_written(std::cout, {csv});
}

} // namespace rbvi
