// rbvi bench: run time against error, on one rank, over the validation set.
#include "rbvi/study/bench.hpp"
#include "failures.hpp"
#include "model_case.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/fem/check_scene.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "rbvi/model/print.hpp"
#include "rbvi/model/training_samples.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/tool/commands.hpp"
#include "rbvi/tool/tables.hpp"
#include "run_directory.hpp"

#include <cmath>
#include <filesystem>
#include <iostream>
#include <sstream>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

std::string error_text(double value) {
  return value < 0 ? "" : formatted("%.1e", value);
}

std::string milliseconds(double seconds) {
  return formatted(seconds < 1 ? "%.3g" : "%.0f", 1e3 * seconds);
}

/// Queries from which the seconds spent offline are won back; "" if never or not applicable.
std::string threshold(const BenchRow &row, double best) {
  if (row.offline == 0 || row.median >= best) return "";
  return formatted("%.0f", std::ceil(row.offline / (best - row.median)));
}

const std::vector<std::string> bench_columns{
    "method", "includes",    "queries",    "median_ms", "p95_ms",       "u_mean",
    "u_max",  "lambda_mean", "lambda_max", "speed_up",  "benefit_from", "outputs_max"};

std::vector<std::string> cells(const BenchRow &row, double best) {
  const bool answers = row.u_mean >= 0, comparable = answers && row.includes != "coefficients";
  return {row.method,
          row.includes,
          std::to_string(row.queries),
          row.queries > 0 ? milliseconds(row.median) : "",
          row.queries > 0 ? milliseconds(row.slow) : "",
          error_text(row.u_mean),
          error_text(row.u_max),
          error_text(row.lambda_mean),
          error_text(row.lambda_max),
          comparable ? formatted("%.3g", best / row.median) : "",
          comparable ? threshold(row, best) : "",
          error_text(row.outputs_max)};
}

std::string markdown(const std::vector<BenchRow> &rows, double best) {
  std::string table =
      table_line(bench_columns, "| ", " | ", " |") +
      table_line(std::vector<std::string>(bench_columns.size(), "---"), "|", "|", "|");
  for (const BenchRow &row : rows)
    table += table_line(cells(row, best), "| ", " | ", " |");
  return table;
}

std::string csv(const std::vector<BenchRow> &rows, double best) {
  std::string table = table_line(bench_columns, "", ",", "");
  for (const BenchRow &row : rows)
    table += table_line(cells(row, best), "\"", "\",\"", "\"");
  return table;
}

Sweep samples_at(Problem &problem, const OfflineOptions &options, const std::vector<Mu> &set,
                 const std::string &name) {
  const Groups alone(PETSC_COMM_SELF, 1);
  Sweep sweep =
      run_sweep(PETSC_COMM_SELF, alone, problem, options.hf, set, {options.out / "samples"});
  check_failures(options.scene.parameters, options.max_failures, sweep.report, set.size(), name);
  return sweep;
}

/// One core's seconds: the snapshots count by their own solve times, because a resumed sweep does
/// not repeat them.
double offline_seconds(const ReducedModel &model, const std::vector<Sample> &snapshots) {
  double sum = 0;
  for (const Sample &snapshot : snapshots)
    sum += snapshot.outputs.seconds.value_or(0);
  for (const auto &[stage, seconds] : model.made.stage_seconds)
    if (stage != "snapshots") sum += seconds;
  return sum;
}

/// Whether vi solves the scene once it has vertex quadrature: one body, without friction.
bool vi_fits(const Scene &scene) {
  return scene.options.contains("lumped") && separable_contact(scene) && !has_friction(scene);
}

std::vector<BenchRow> bench_baselines(Problem &problem, const Setup &options,
                                      const std::vector<Sample> &truths) {
  constexpr std::size_t few_slow = 3, few = 8;
  std::vector<BenchRow> rows;
  HfOptions hf = options.hf;
  hf.method = HfMethod::active_set;
  rows.push_back(bench_solver(problem, hf, truths, truths.size(), From::last));
  if (!has_multipliers(problem.scene())) {
    rows.push_back(bench_solver(problem, hf, truths, few, From::cold));
    return rows;
  }
  const bool follows = follows_state(problem.contact());
  for (BenchRow &part : follows ? bench_iterations(problem, truths) : bench_parts(problem, truths))
    rows.push_back(std::move(part));
  rows.push_back(bench_solver(problem, hf, truths, truths.size(), From::cold));
  if (follows || !problem.free_bodies().empty()) return rows; // Uzawa's steps take no end there
  hf.method = HfMethod::uzawa;
  hf.uzawa.accelerated = true;
  rows.push_back(bench_solver(problem, hf, truths, few, From::cold));
  hf.uzawa.accelerated = false;
  rows.push_back(bench_solver(problem, hf, truths, few_slow, From::cold));
  if (vi_fits(options.scene)) {
    SceneOptions lumped = options.scene.options;
    lumped["lumped"] = "yes";
    Scene scene = make_scene(entry_of(*options.registry, options.scene.name), lumped);
    scene.parameters = options.scene.parameters;
    Problem vertex_quadrature(PETSC_COMM_SELF, scene, options.mesh);
    std::vector<Mu> set = parameters_of(truths);
    set.resize(std::min(few, set.size()));
    rows.push_back(bench_vi(vertex_quadrature, set));
  }
  return rows;
}

void bench(const MeasureOptions &options, const ReducedModel &model, int ranks) {
  Problem problem(PETSC_COMM_SELF, options.scene, options.mesh);
  check_scene(problem);
  check_problem(problem, model, options.out);
  const std::vector<Sample> snapshots =
      samples_at(problem, options, from_columns(model.made.trained_mu), "training").samples;
  const std::vector<Mu> validation = validation_set(options, model);
  const Sweep sweep = samples_at(problem, options, validation, "validation");
  const std::vector<Sample> &truths = sweep.samples;

  std::vector<BenchRow> rows = bench_baselines(problem, options, truths);
  if (rows.front().queries == 0) throw failure(rows.front().includes);
  const double best = rows.front().median, offline = offline_seconds(model, snapshots);
  rows.push_back(bench_interpolation(problem, snapshots, truths));
  for (BenchRow &row : bench_models(problem, model, truths, offline))
    rows.push_back(std::move(row));

  std::ostringstream head;
  head << "Scene " << model.scene.name << ", " << problem.mesh().total_nodes << " nodes, "
       << truths.size() << " validation parameters, timed on 1 of " << ranks << " ranks.\n"
       << "Errors are relative to the samples of the run (vi: of the lumped scene), u in V, lambda "
          "in W; "
          "reduced (N+S, R).\n"
       << "outputs_max: energy, forces and pressures, relative to the range of each.\n"
       << "speed_up: against the first row, which has outputs and field; coefficients alone are no "
          "answer;\n"
       << "benefit_from: queries from which " << formatted("%.2f", offline)
       << " s offline are won back\n"
       << "(" << snapshots.size() << " snapshots by their solve times, plus the other stages).\n\n";
  const std::string table = head.str() + markdown(rows, best);
  sweep_up(options.out);
  make_directory(options.out / "bench");
  write_atomically(options.out / "bench" / "table.md", table);
  write_atomically(options.out / "bench" / "table.csv", csv(rows, best));
  std::printf("%s\n", table.c_str());
  print_written(std::cout,
                {options.out / "bench" / "table.md", options.out / "bench" / "table.csv"});
  report_failures(options.scene.parameters, sweep.report, validation.size(), "validation",
                  "measured over the others");
}

} // namespace

void command_bench(const MeasureOptions &given) {
  if (!given.growth.empty()) return command_growth(given);
  if (!given.convergence.empty()) return command_convergence(given);
  const MPI_Comm world = PETSC_COMM_WORLD;
  const int rank = rank_of(world), ranks = ranks_of(world);
  const ReducedModel model = model_of_run(world, given);
  const MeasureOptions options = adopt_model(given, model);
  check_eigen_options(options, EigenUse::none);
  collectively(world, [&] {
    if (rank == 0) bench(options, model, ranks);
  });
}

} // namespace rbvi
