// rbvi offline: from a case file to a model file.
#include "rbvi/core/error.hpp"
#include "rbvi/core/h5.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/tool/commands.hpp"
#include "rbvi/tool/stages.hpp"
#include "rbvi/tool/tables.hpp"
#include "rbvi/tool/workspace.hpp"

#include <cstdio>

namespace rbvi {

namespace {

std::map<std::string, std::string> model_settings(const ToolOptions &options, std::size_t samples) {
  std::map<std::string, std::string> settings{
      {"training", options.train},
      {"samples", std::to_string(samples)},
      {"mesh_refine", std::to_string(options.mesh.refine)},
      {"pod_tolerance", short_number(options.reduce.pod.tolerance)},
      {"eim_tolerance", short_number(options.reduce.eim.tolerance)}};
  if (options.scene.nitsche) {
    settings["nitsche_quadrature"] =
        curve_rule_names()[static_cast<std::size_t>(options.reduce.curve.rule)];
    return settings;
  }
  if (options.scene.support) {
    const MultiplierOptions &choice = options.reduce.multipliers;
    settings["condensed_tolerance"] = short_number(options.reduce.condensed.tolerance);
    settings["multiplier_reduction"] =
        multiplier_reduction_names()[static_cast<std::size_t>(choice.reduction)];
    if (choice.reduction == MultiplierReduction::condensed) return settings;
    settings["tangential_tolerance"] = short_number(choice.tangential);
  }
  settings.merge(std::map<std::string, std::string>{
      {"cone_type", cone_type_names()[static_cast<std::size_t>(options.reduce.cone.type)]},
      {"cone_tolerance", short_number(options.reduce.cone.tolerance)},
      {"cone_feasibility", short_number(options.reduce.cone.feasibility)},
      {"cone_ring", std::to_string(options.reduce.cone.ring)},
      {"pga_enrichment", enrichment_names()[static_cast<std::size_t>(options.reduce.enrichment)]},
      {"pga_product", product_names()[static_cast<std::size_t>(options.reduce.product)]},
      {"pga_tolerance", short_number(options.reduce.pga.tolerance)},
      {"pga_beta_fraction", short_number(options.reduce.pga.stability)}});
  return settings;
}

void print_failures(const SweepReport &report, const ParameterSpace &space) {
  for (const auto &[mu, reason] : report.failed)
    std::printf("  failed at %s: %s\n", describe(space, mu).c_str(), reason.c_str());
}

/// Collective. The run directory with its case file, so that the other commands need not be told.
void write_case_file(MPI_Comm world, const ToolOptions &options) {
  collectively(world, [&] {
    int rank = 0;
    MPI_Comm_rank(world, &rank);
    if (rank == 0) write_atomically(case_of_run(options.out), options.case_file);
  });
}

} // namespace

void command_offline(const ToolOptions &options) {
  const MPI_Comm world = PETSC_COMM_WORLD;
  const std::vector<Mu> training = parse_set(options.scene.parameters, options.train);
  if (options.scene.support) check_support_reduction(options.scene, options.reduce);
  const Groups groups(world, options.ranks_per_solve);
  int rank = 0;
  MPI_Comm_rank(world, &rank);
  if (rank == 0) print_stages(offline_stages(options, training.size(), groups.count()), {});
  if (options.plan) return;
  if (options.out.empty()) throw bad_input("no run directory is named: use -out run/NAME");
  check_outputs(world, options,
                {{"the reduced model", options.out / "model.h5"},
                 {"the table", options.out / "samples.csv"}});

  StageTimes times;
  Sweep sweep;
  Workspace work(world, groups, options, times);
  {
    const Stage stage("snapshots", times);
    sweep = run_sweep(world, groups, work.group_problem(), options.hf, training,
                      options.out / "samples");
  }
  if (rank == 0) print_failures(sweep.report, options.scene.parameters);
  if (sweep.samples.empty()) throw failure("no sample succeeded: see the reasons above");
  write_case_file(world, options);

  Problem &problem = work.world_problem(times);
  Reduction made = reduce(problem, sweep.samples, options.reduce, times);
  ReducedModel &model = made.model;
  model.settings = model_settings(options, sweep.samples.size());
  for (const auto &[stage, seconds] : times)
    model.stage_seconds[stage] = seconds;
  {
    const Stage stage("writing", times);
    collectively(world, [&] {
      if (rank != 0) return;
      write_model(model, options.out / "model.h5");
      write_sample_table(options.out / "samples.csv", options.scene.parameters, sweep.samples);
    });
  }
  if (rank != 0) return;
  const OfflineResult result{sweep.report, made};
  print_stages(offline_stages(options, training.size(), groups.count(), &result), times);
  std::printf("Model: %s\n", (options.out / "model.h5").c_str());
}

} // namespace rbvi
