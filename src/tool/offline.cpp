// rbvi offline: from a case file to a model file.
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/element/imposed.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/model/print.hpp"
#include "rbvi/model/self_check.hpp"
#include "rbvi/model/training_samples.hpp"
#include "rbvi/mor/fields.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/contact_cost.hpp"
#include "rbvi/sweep/grouping.hpp"
#include "rbvi/tool/commands.hpp"
#include "rbvi/tool/failures.hpp"
#include "rbvi/tool/offline_run.hpp"
#include "rbvi/tool/run_directory.hpp"
#include "rbvi/tool/tables.hpp"
#include "rbvi/tool/workspace.hpp"

#include <cstdio>
#include <iostream>
#include <set>

namespace rbvi {

namespace {

/// By whom samples are solved, and how the linear systems of contact: that takes the mesh to tell.
void print_solve_plan(MPI_Comm world, const Grouping &grouping, const Groups &groups,
                      const ToolOptions &options, std::size_t samples) {
  if (rank_of(world) == 0) std::printf("%s\n", grouping.text.c_str());
  if (options.hf.method != HfMethod::active_set || !has_multipliers(options.scene)) return;
  const Workspace work(world, groups, options);
  HfOptions hf = options.hf;
  hf.samples = static_cast<int>(samples) / groups.count();
  if (rank_of(world) == 0)
    std::printf("Contact is %s\n", contact_cost_text(work.group_problem(), hf).c_str());
}

/// Throws bad_input where displacements that the scene imposes at some training parameter are not
/// finite or contradict each other. Collective on the problem's ranks.
void check_imposed_at(const Problem &problem, const std::vector<Mu> &training) {
  const Scene &scene = problem.scene();
  if (!imposes_values(scene)) return;
  for (const Mu &mu : training)
    check_imposed(scene, expand(scene.parameters, mu), problem.mesh(), problem.dofs());
}

/// Where the model has samples, and where it was to have them.
void name_training(const Sweep &sweep, ReducedModel &model) {
  std::vector<Mu> failed;
  for (const auto &[mu, reason] : sweep.report.failed)
    failed.push_back(mu);
  model.made.trained_mu = as_columns(parameters_of(sweep.samples), model.scene.parameters.size());
  model.made.failed_mu = as_columns(failed, model.scene.parameters.size());
}

/// That nobody knows the errors of a new model; and where it has so few samples that it cannot even
/// follow a linear function of the parameters.
void tell_of_errors(const ReducedModel &model, const std::filesystem::path &run) {
  std::printf("Its errors are not measured: rbvi verify -out %s compares it with high-fidelity "
              "answers\n",
              run.c_str());
  const std::vector<Mu> trained = from_columns(model.made.trained_mu);
  const auto distinct = std::ssize(std::set<Mu>(trained.begin(), trained.end()));
  if (distinct > model.scene.parameters.size()) return;
  std::printf(
      "warning: %s for %s: the tolerances are met at these samples, which says nothing about "
      "the rest of the box; give a larger -train\n",
      counted(distinct, "different sample").c_str(),
      counted(model.scene.parameters.size(), "free parameter").c_str());
}

} // namespace

std::vector<Mu> checked_training(const ToolOptions &options) {
  std::vector<Mu> training = parse_set(options.scene.parameters, options.train);
  check_set(options.scene, training);
  check_reduction(options.scene, options.reduce);
  check_eigen_options(options, EigenUse::supremizers);
  return training;
}

OfflineRun run_offline(MPI_Comm world, const Groups &groups, const ToolOptions &options,
                       const std::vector<Mu> &training) {
  StageTable before = preparation_stages(options, training.size(), groups);
  StageTable after = closing_stages();
  Workspace work = timed(before, stage::mesh, [&] { return Workspace(world, groups, options); });
  check_imposed_at(work.group_problem(), training);
  Sweep sweep = timed(before, stage::snapshots, [&] {
    return run_sweep(
        world, groups, work.group_problem(), options.hf, training,
        {options.out / "samples", [&] { begin_run(world, options); }, Fields::in_files});
  });
  work.end_of_solves();
  check_failures(options, sweep.report, training.size(), "training");
  if (will_run(before, stage::distributed_mesh))
    timed(before, stage::distributed_mesh, [&] { work.world_problem(); });
  before =
      finished_stages(before, preparation_stages(options, training.size(), groups, &sweep.report));
  Problem &problem = work.world_problem();
  Reduction made = reduce(problem, sweep.samples, options.reduce);
  ReducedModel model = std::move(made.model);
  model.made.settings.merge(kept_settings(options)); // beside the whole scene
  model.made.settings["samples"] = std::to_string(sweep.samples.size());
  if (model.made.settings.contains("cone_ring"))
    model.made.settings["cone_ring"] = std::to_string(made.ring);
  name_training(sweep, model);
  for (const StageTable &table : {before, made.stages})
    for (const StageRow &row : table)
      if (row.seconds) model.made.stage_seconds[row.stage.text] = *row.seconds;
  timed(after, stage::writing, [&] {
    write_fields(work.world_problem(), made.bases.pod.basis, model, options.out / "model.h5");
    collectively(world, [&] {
      if (rank_of(world) != 0) return;
      write_model(model, options.out / "model.h5");
      write_sample_table(options.out / "samples.csv", options.scene.parameters, sweep.samples);
    });
  });
  return {std::move(sweep),
          std::move(model),
          {before, made.stages, finished_stages(after, closing_stages())},
          static_cast<int>(problem.mesh().total_nodes),
          static_cast<int>(problem.dofs().total),
          static_cast<int>(problem.dual_size())};
}

void command_offline(const ToolOptions &options) {
  const MPI_Comm world = PETSC_COMM_WORLD;
  const std::vector<Mu> training = checked_training(options);
  const Grouping grouping =
      group_ranks(world, options.scene, options.mesh, training.size(), options.ranks_per_solve);
  const Groups groups(world, grouping.ranks_per_solve);
  const int rank = rank_of(world);
  if (rank == 0)
    print_stages({preparation_stages(options, training.size(), groups),
                  reduction_stages(options.scene, options.reduce), closing_stages()});
  if (options.plan) return print_solve_plan(world, grouping, groups, options, training.size());
  if (options.out.empty()) throw bad_input("no run directory is named: use -out run/NAME");
  check_outputs(world, options,
                {{"the reduced model", options.out / "model.h5"},
                 {"its fields", fields_file(options.out / "model.h5")},
                 {"the table", options.out / "samples.csv"}});

  const OfflineRun run = run_offline(world, groups, options, training);
  if (rank == 0) {
    print_stages(run.stages);
    std::cout << "Self-check: ";
    print_self_check(std::cout, run.model.made.self_check, run.model.scene.parameters);
    tell_of_errors(run.model, options.out);
    print_several_answers(std::cout, run.model);
    tell_of_samples(options.scene, contact_of(run.model, options.scene), run.sweep.samples,
                    std::cout);
    print_written(std::cout,
                  {options.out / "model.h5", fields_file(options.out / "model.h5"),
                   options.out / "samples.csv", case_of_run(options.out), options.out / "samples"});
  }
  report_failures(options, run.sweep.report, training.size(), "training",
                  "the model is made from the others, and answers next to a failed one with a "
                  "warning");
}

} // namespace rbvi
