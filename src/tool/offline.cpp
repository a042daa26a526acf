// rbvi offline: from a case file to a model file.
#include "failures.hpp"
#include "greedy.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/element/imposed.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/mesh/contact_curves.hpp"
#include "rbvi/model/print.hpp"
#include "rbvi/model/self_check.hpp"
#include "rbvi/model/training_samples.hpp"
#include "rbvi/mor/fields.hpp"
#include "rbvi/mor/output_candidates.hpp"
#include "rbvi/mor/reduced_balance.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/scene/stored_scene.hpp"
#include "rbvi/solve/contact_cost.hpp"
#include "rbvi/sweep/grouping.hpp"
#include "rbvi/tool/commands.hpp"
#include "rbvi/tool/offline_run.hpp"
#include "rbvi/tool/tables.hpp"
#include "rbvi/tool/workspace.hpp"
#include "run_directory.hpp"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <iostream>
#include <optional>
#include <set>
#include <utility>

namespace rbvi {

namespace {

/// The stages, by whom samples are solved, how the linear systems of contact, and the memory.
void print_plan(const Grouping &grouping, const OfflineOptions &options, const OfflinePlan &plan) {
  print_stages(plan.stages, plan.foreseen);
  std::printf("%s\n", grouping.text.c_str());
  if (options.hf.method == HfMethod::active_set && has_multipliers(options.scene))
    std::printf("Contact is %s\n", contact_cost_text(plan.work.group_problem(), plan.hf).c_str());
  std::printf("%s\n", memory_text(plan.foreseen, plan.stages, plan.room).c_str());
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

bool same_box(const ParameterSpace &one, const ParameterSpace &two) {
  return one.free == two.free &&
         std::ranges::equal(one.all, two.all, [](const Parameter &p, const Parameter &q) {
           return p.name == q.name && p.lower == q.lower && p.upper == q.upper &&
                  p.value == q.value;
         });
}

/// Whether reducing these samples would make this model again, but for its outputs.
bool is_made_of(const ReducedModel &model, const OfflineOptions &options, const Problem &problem,
                const Sweep &sweep) {
  std::map<std::string, std::string> settings = kept_settings(options), own = model.made.settings;
  settings["samples"] = std::to_string(sweep.samples.size());
  for (auto *of : {&settings, &own})
    of->erase("cone_ring"); // what it was widened to
  const std::vector<Mu> mus = parameters_of(sweep.samples);
  const bool reaches = model.contact.trace_dofs.empty() || problem.scene().outputs.empty();
  return settings == own && scene_difference(model.scene.tree, problem.scene().tree).empty() &&
         from_columns(model.made.trained_mu) == mus && reaches &&
         same_box(model.scene.parameters, problem.scene().parameters) &&
         model.made.mesh_fingerprint == problem.mesh().fingerprint;
}

/// The rows of fields at some nodes.
Matrix rows_at(const Matrix &fields, const std::vector<int> &nodes, Index components) {
  Matrix rows(std::ssize(nodes) * components, fields.cols());
  for (std::size_t k = 0; k < nodes.size(); ++k)
    rows.middleRows(static_cast<Index>(k) * components, components) =
        fields.middleRows(nodes[k] * components, components);
  return rows;
}

/// The model that is in the run directory with the outputs of this scene in place of its own, where
/// nothing else is other.
std::optional<ReducedModel> read_kept(const OfflineOptions &options, const Problem &problem,
                                      const Sweep &sweep) {
  const std::filesystem::path path = options.out / "model.h5";
  try {
    ReducedModel model = read_model(path, *options.registry, false);
    const Scene &scene = problem.scene();
    if (!is_made_of(model, options, problem, sweep) ||
        scene_difference(model.scene.tree, scene.tree, Compared::answers_and_outputs).empty())
      return std::nullopt;
    model.outputs.cells =
        candidate_cells(MPI_COMM_SELF, scene, problem.output_cells(), sweep.samples);
    model.outputs.basis = {};
    if (const std::vector<int> &nodes = model.outputs.cells.nodes; !nodes.empty()) {
      ReducedModel with_fields = read_model(path, *options.registry);
      model.outputs.basis = rows_at(with_fields.fields.basis, nodes, scene.components);
    }
    model.scene = scene;
    model.made.validation_enriched = model.made.validation_decorrelated = {}; // of other outputs
    model.made.validated_mu = {};
    return model;
  } catch (const Error &) { // none, or one of another version
    return std::nullopt;
  }
}

/// read_kept() on the first rank, the others have an empty model. Collective.
std::optional<ReducedModel> with_other_outputs(MPI_Comm world, const OfflineOptions &options,
                                               const Problem &problem, const Sweep &sweep) {
  if (!options.registry || sweep.report.solved > 0) return std::nullopt;
  std::optional<ReducedModel> model;
  int found = 0;
  if (rank_of(world) == 0) {
    model = read_kept(options, problem, sweep);
    found = model.has_value() ? 1 : 0;
  }
  MPI_Bcast(&found, 1, MPI_INT, 0, world);
  if (found != 0 && !model) model.emplace();
  return model;
}

/// What reduce() has made, with its settings, training set and times.
ReducedModel finished_model(Reduction &made, const OfflineOptions &options, const Sweep &sweep,
                            const StageTable &before) {
  ReducedModel model = std::move(made.model);
  model.made.settings.merge(kept_settings(options));
  model.made.settings["samples"] = std::to_string(sweep.samples.size());
  if (model.made.settings.contains("cone_ring"))
    model.made.settings["cone_ring"] = std::to_string(made.ring);
  name_training(sweep, model);
  for (const StageTable &table : {before, made.stages})
    for (const StageRow &row : table)
      if (row.seconds) model.made.stage_seconds[row.stage.text] = *row.seconds;
  return model;
}

/// Reads a model back and asks it the first of what the self-check asked, and what is at the
/// boundary of the box. Throws failure where its file cannot be read, or answers less than the
/// model did.
void check_written(const ReducedModel &model, const std::filesystem::path &file,
                   const Registry *registry) {
  if (registry == nullptr) return; // who knows its functions
  const SelfCheck &asked = model.made.self_check;
  std::string reason;
  try {
    const ReducedModel read = read_model(file, *registry, false);
    if (asked.queries == 0) return;
    constexpr int some = 5;
    const int random = asked.queries - asked.at_boundary;
    const SelfCheck again = self_check(read, read.scene, std::min(some, random));
    if (again.unanswered > asked.unanswered) reason = again.reason;
  } catch (const Error &error) {
    reason = error.what();
  }
  if (!reason.empty())
    throw failure("the model in " + file.string() + " is not the one that was made: " + reason);
}

/// That nobody knows the errors of a new model; where it has so few samples that it cannot even
/// follow a linear function of the parameters; and which of them no sample varies.
void tell_of_errors(const ReducedModel &model, const std::filesystem::path &run) {
  std::printf("Its errors are not measured: rbvi verify -out %s compares it with high-fidelity "
              "answers\n",
              run.c_str());
  const std::vector<Mu> trained = from_columns(model.made.trained_mu);
  for (int i = 0; i < model.scene.parameters.size() && trained.size() > 1; ++i)
    if (std::ranges::all_of(trained, [&](const Mu &mu) { return mu[i] == trained.front()[i]; }))
      std::printf(
          "warning: all samples have one %s, and the model knows nothing of others: vary it "
          "in -train, or give it that value (-%s VALUE)\n",
          model.scene.parameters.at(i).name.c_str(), model.scene.parameters.at(i).name.c_str());
  const auto distinct = std::ssize(std::set<Mu>(trained.begin(), trained.end()));
  if (distinct > model.scene.parameters.size()) return;
  std::printf(
      "warning: %s for %s: the tolerances are met at these samples, which says nothing about "
      "the rest of the box; give a larger -train\n",
      counted(distinct, "different sample").c_str(),
      counted(model.scene.parameters.size(), "free parameter").c_str());
}

/// What -greedy leaves: the largest bound of each model, and what the last one is.
struct GreedyModels {
  std::vector<double> bounds;
  std::optional<Reduction> last;
};

/// Samples at the training set and, where -greedy asks for it, at those of its pool that bounds of
/// the errors of models of the samples before choose. Collective.
Sweep chosen_samples(MPI_Comm world, const OfflineOptions &options, const Groups &groups,
                     std::vector<Mu> set, Workspace &work,
                     const std::function<Sweep(const std::vector<Mu> &)> &sweep_at,
                     GreedyModels &models) {
  const GreedyPool pool = greedy_pool(options);
  Sweep sweep = sweep_at(set);
  if (pool.candidates.empty()) return sweep;
  while (true) {
    Problem &problem = work.world_problem();
    models.last.reset(); // one basis at a time
    const Reduction &made = models.last.emplace(reduce(problem, sweep.samples, options.reduce));
    if (!made.no_bounds.empty())
      throw failure("-greedy chooses samples by bounds of errors, and there are none: " +
                    made.no_bounds);
    const NextSamples next = next_samples(
        world, made.model, problem.scene(), pool.candidates, set,
        std::min<std::size_t>(groups.count(), pool.most - std::min(pool.most, set.size())));

    models.bounds.push_back(next.largest);
    if (rank_of(world) == 0)
      std::printf(
          "  %zu samples: largest bound %s%s\n", set.size(), short_number(next.largest).c_str(),
          next.mu.empty() ? ""
                          : (" at " + describe(options.scene.parameters, next.mu.front())).c_str());
    if (next.largest <= pool.tolerance || next.mu.empty()) return sweep;
    set.insert(set.end(), next.mu.begin(), next.mu.end());
    sweep = sweep_at(set);
  }
}

} // namespace

std::vector<Mu> checked_training(const OfflineOptions &options) {
  std::vector<Mu> training =
      parse_set(options.scene.parameters, options.train, false, options.scene.outputs);
  check_set(options.scene, training);
  check_reduction(options.scene, options.reduce);
  check_eigen_options(options, EigenUse::supremizers);
  greedy_pool(options);
  return training;
}

OfflinePlan plan_offline(MPI_Comm world, const Groups &groups, const OfflineOptions &options,
                         const std::vector<Mu> &training) {
  const std::vector<StageTable> stages{preparation_stages(options, training.size(), groups),
                                       reduction_stages(options.scene, options.reduce),
                                       closing_stages()};
  const RunSizes counted = sizes_by_count(world, groups, options);
  check_memory(foresee(options, training, counted), stages, room_for(world));
  StageTable before = stages.front();
  Workspace work = timed(before, stage::mesh, [&] { return Workspace(world, groups, options); });
  HfOptions hf = options.hf;
  hf.samples = static_cast<int>(training.size()) / groups.count();
  collectively(world, [&] {
    if (!options.out.empty()) check_samples(work.group_problem(), hf, options.out / "samples");
  });
  const RunSizes sizes = sizes_of(world, work.group_problem(), hf, counted);
  return {stages,         std::move(before), std::move(work), hf, foresee(options, training, sizes),
          room_for(world)};
}

OfflineRun run_offline(MPI_Comm world, const Groups &groups, const OfflineOptions &options,
                       const std::vector<Mu> &training, OfflinePlan plan) {
  check_memory(plan.foreseen, plan.stages, plan.room);
  StageTable before = std::move(plan.before), after = closing_stages();
  Workspace work = std::move(plan.work);
  check_imposed_at(work.group_problem(), training);
  const auto sweep_at = [&](const std::vector<Mu> &set) {
    return run_sweep(
        world, groups, work.group_problem(), options.hf, set,
        {options.out / "samples", [&] { begin_run(world, options); }, Fields::in_files});
  };

  GreedyModels greedy;

  Sweep sweep = timed(before, stage::snapshots, [&] {
    return chosen_samples(world, options, groups, training, work, sweep_at, greedy);
  });
  work.end_of_solves();
  const std::size_t solved = sweep.samples.size() + sweep.report.failed.size();
  check_failures(options.scene.parameters, options.max_failures, sweep.report, solved, "training");
  if (will_run(before, stage::distributed_mesh))
    timed(before, stage::distributed_mesh, [&] { work.world_problem(); });
  before = finished_stages(before, preparation_stages(options, solved, groups, &sweep.report));
  Problem &problem = work.world_problem();
  StageTable reduction;
  std::optional<ReducedModel> kept = with_other_outputs(world, options, problem, sweep);
  LinearBasis fields; // not written yet
  ReducedModel model;
  if (kept) {
    model = *std::move(kept);
    compare_balance(problem, model);
  } else {
    Reduction made = greedy.last ? *std::exchange(greedy.last, {})
                                 : reduce(problem, sweep.samples, options.reduce);
    model = finished_model(made, options, sweep, before);
    if (!greedy.bounds.empty()) model.made.histories["greedy/bound"] = greedy.bounds;
    reduction = std::move(made.stages);
    fields = std::move(made.bases.pod.basis);
  }
  timed(after, stage::writing, [&] {
    if (fields.columns.get() != nullptr)
      write_fields(work.world_problem(), fields, model, options.out / "model.h5");
    collectively(world, [&] {
      if (rank_of(world) != 0) return;
      write_model(model, options.out / "model.h5");
      check_written(model, options.out / "model.h5", options.registry.get());
      write_sample_table(options.out / "samples.csv", options.scene.parameters, sweep.samples);
    });
  });
  std::vector<StageTable> stages{before, reduction, finished_stages(after, closing_stages())};
  for (StageTable &table : stages)
    for (StageRow &row : table)
      MPI_Allreduce(MPI_IN_PLACE, &row.peak, 1, MPI_DOUBLE, MPI_MAX, world);
  return {std::move(sweep),
          std::move(model),
          std::move(stages),
          static_cast<int>(problem.mesh().total_nodes),
          static_cast<int>(problem.dofs().total),
          static_cast<int>(problem.dual_size())};
}

void command_offline(const OfflineOptions &options) {
  const MPI_Comm world = PETSC_COMM_WORLD;
  const std::vector<Mu> training = checked_training(options);
  const Grouping grouping =
      group_ranks(world, options.scene, options.mesh, training.size(), options.ranks_per_solve);
  const Groups groups(world, grouping.ranks_per_solve);
  const int rank = rank_of(world);
  if (!options.plan && options.out.empty())
    throw bad_input("no run directory is named: use -out run/NAME");
  if (!options.plan)
    check_outputs(world, options, options.mesh.file,
                  {{"the reduced model", options.out / "model.h5"},
                   {"its fields", fields_file(options.out / "model.h5")},
                   {"the table", options.out / "samples.csv"}});
  OfflinePlan plan = plan_offline(world, groups, options, training);
  if (rank == 0 && options.plan) print_plan(grouping, options, plan);
  if (options.plan) return check_memory(plan.foreseen, plan.stages, plan.room);
  if (rank == 0) print_stages(plan.stages, plan.foreseen);
  const Foresight foreseen = plan.foreseen;
  const OfflineRun run = run_offline(world, groups, options, training, std::move(plan));
  if (rank == 0) {
    print_stages(run.stages, foreseen);
    if (run.stages[1].empty())
      std::printf("The model is the one that was there: its outputs alone have changed\n");
    std::cout << "Self-check: ";
    print_self_check(std::cout, run.model.made.self_check, run.model.scene.parameters);
    tell_of_errors(run.model, options.out);
    print_several_answers(std::cout, run.model);
    warn_of_balance(std::cout, run.model);
    tell_of_samples(options.scene, contact_of(run.model, options.scene), run.sweep.samples,
                    std::cout);
    warn_of_edges(options.scene, options.mesh.file, std::cout);
    print_written(std::cout,
                  {options.out / "model.h5", fields_file(options.out / "model.h5"),
                   options.out / "samples.csv", case_of_run(options.out), options.out / "samples"});
  }
  warn_of_eigen_options(world, options);
  report_failures(options.scene.parameters, run.sweep.report,
                  run.sweep.samples.size() + run.sweep.report.failed.size(), "training",
                  "the model is made from the others, and answers next to a failed one with a "
                  "warning");
}

} // namespace rbvi
