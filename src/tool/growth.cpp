// rbvi bench -bench_growth: what offline takes on several meshes, by several ranks per solve.
#include "rbvi/tool/growth.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "rbvi/model/print.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/tool/case_file.hpp"
#include "rbvi/tool/commands.hpp"
#include "rbvi/tool/offline_run.hpp"

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <sstream>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

/// The text of a case file with another value of an option.
std::string with_option(const std::string &case_file, const std::string &name,
                        const std::string &value) {
  std::istringstream lines(case_file);
  std::string text;
  for (std::string line; std::getline(lines, line);)
    if (!line.starts_with(name + ":")) text += line + "\n";
  return text + case_line(name, value);
}

/// The options of one run, in a directory of its own.
OfflineOptions options_of_run(const OfflineOptions &options, int refine, int ranks_per_solve) {
  OfflineOptions of_run = options;
  const std::string level = std::to_string(refine), ranks = std::to_string(ranks_per_solve);
  of_run.mesh.refine = refine;
  of_run.ranks_per_solve = ranks_per_solve;
  of_run.out = options.out / "bench" / ("growth_refine" + level + "_ranks" + ranks);
  of_run.case_file = with_option(with_option(options.case_file, "mesh_refine", level),
                                 "sweep_ranks_per_solve", ranks);
  return of_run;
}

void remove_directory(MPI_Comm world, const fs::path &directory) {
  collectively(world, [&] {
    if (rank_of(world) == 0)
      while_doing("removing " + directory.string(), [&] { fs::remove_all(directory); });
  });
}

/// The size of a file on rank 0; 0 where there is none.
double file_bytes(MPI_Comm world, const fs::path &file) {
  std::error_code none;
  if (rank_of(world) != 0 || !fs::exists(file, none)) return 0;
  const auto size = fs::file_size(file, none);
  return none ? 0 : static_cast<double>(size);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void describe_samples(const std::vector<Sample> &samples, GrowthRun &run) {
  std::vector<double> iterations;
  for (const Sample &sample : samples) {
    iterations.push_back(sample.outputs.iterations.value_or(0));
    run.contact_nodes = std::max(run.contact_nodes, sample.outputs.contact_nodes.value_or(0));
  }
  run.samples = static_cast<int>(samples.size());
  run.iterations = median(iterations);
}

/// Runs the pipeline and takes its directory away again. Collective.
GrowthRun measure(MPI_Comm world, const OfflineOptions &options, const std::vector<Mu> &training) {
  GrowthRun run;
  run.scene = options.scene.name;
  run.refine = options.mesh.refine;
  run.ranks = ranks_of(world);
  run.ranks_per_solve = options.ranks_per_solve;
  StageCost before;
  before.memory = resident_bytes();
  run.resident = costs_over_ranks(world, before).largest.memory;
  remove_directory(world, options.out);
  const Groups groups(world, options.ranks_per_solve);
  const OfflineRun made =
      run_offline(world, groups, options, training, plan_offline(world, groups, options, training));
  run.nodes = made.nodes;
  run.dofs = made.dofs;
  run.multipliers = made.multipliers;
  run.modes = made.model.primal_size();
  run.failed = static_cast<int>(made.sweep.report.failed.size());
  run.sample_seconds = made.sweep.report.seconds_per_solve;
  describe_samples(made.sweep.samples, run);
  for (const StageTable &table : made.stages)
    for (const StageRow &row : table)
      if (row.cost) run.stages.emplace_back(row.stage.text, costs_over_ranks(world, *row.cost));
  run.model_bytes = file_bytes(world, options.out / "model.h5");
  run.fields_bytes = file_bytes(world, fields_file(options.out / "model.h5"));
  remove_directory(world, options.out);
  return run;
}

/// Every number that divides the ranks, or the one that the options ask for.
std::vector<int> groupings(const OfflineOptions &options, int ranks) {
  if (options.ranks_per_solve != 0) return {options.ranks_per_solve};
  std::vector<int> divisors;
  for (int number = 1; number <= ranks; ++number)
    if (ranks % number == 0) divisors.push_back(number);
  return divisors;
}

void tell(const GrowthRun &run) {
  const StageCost total = total_cost(run).largest;
  std::printf("%d dofs, %s per solve: %.3f s, %.0f MB per rank, %.0f factorisations\n", run.dofs,
              counted(run.ranks_per_solve, "rank").c_str(), total.seconds, total.memory / 1e6,
              total.factorisations);
  std::fflush(stdout);
}

} // namespace

void command_growth(const MeasureOptions &options) {
  const MPI_Comm world = PETSC_COMM_WORLD;
  const std::vector<Mu> training = checked_training(options);
  if (options.out.empty()) throw bad_input("no run directory is named: use -out run/NAME");
  const fs::path table = options.out / "bench" / "growth.csv";
  check_outputs(world, options, options.mesh.file, {{"the table", table}});
  const std::vector<int> per_solve = groupings(options, ranks_of(world));
  for (const int number : per_solve)
    (void)Groups(world, number); // throws before anything is written
  measure_costs();
  std::vector<GrowthRun> runs;
  for (const int refine : options.growth)
    for (const int number : per_solve) {
      runs.push_back(measure(world, options_of_run(options, refine, number), training));
      if (rank_of(world) == 0) tell(runs.back());
    }
  collectively(world, [&] {
    if (rank_of(world) != 0) return;
    make_directory(table.parent_path());
    write_atomically(table, growth_csv(runs));
    print_written(std::cout, {table});
  });
}

} // namespace rbvi
