#include "rbvi/tool/foreseen.hpp"

#include "rbvi/core/box.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/mor/reduction.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/contact_cost.hpp"
#include "rbvi/solve/scaled_part.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace rbvi {

namespace {

std::string mesh_text(const MeshOptions &mesh, const Scene &scene) {
  return (mesh.file.empty() ? "built in: " + scene.mesh.generator : "file " + mesh.file) +
         (mesh.refine > 0 ? ", refined " + counted(mesh.refine, "time") : "");
}

StageRow snapshot_row(std::size_t training, const Groups &groups, const SweepReport *sweep) {
  const std::string shared =
      " by " + counted(groups.count(), "group") + " of " + counted(ranks_of(groups.comm()), "rank");
  if (sweep == nullptr)
    return {stage::snapshots, std::to_string(training) + " high-fidelity solves" + shared +
                                  ", those that are there reused"};
  if (sweep->solved == 0 && sweep->failed.empty())
    return {stage::snapshots, "all " + std::to_string(sweep->reused) + " were there",
            StageKind::nothing_to_do};
  std::string what = std::to_string(sweep->solved) + " solved" + shared;
  if (sweep->solved > 0) what += ", median " + short_number(1e3 * sweep->seconds_per_solve) + " ms";
  if (sweep->reused > 0) what += "; " + std::to_string(sweep->reused) + " reused";
  if (!sweep->failed.empty()) what += "; " + std::to_string(sweep->failed.size()) + " failed";
  return {stage::snapshots, what};
}

/// What of the solves is done once for all mu.
std::string factorisation_text(const Setup &setup) {
  if (!has_multipliers(setup.scene))
    return "one serves many Newton steps, as long as conjugate gradients need few iterations";
  if (constant_stiffness(setup.scene))
    return "A does not depend on mu: one for the sweep, one condensed operator";
  if (setup.hf.method == HfMethod::active_set && ScaledPart::fits(setup.scene))
    return "a part of A is scaled: three for the sweep of each group, the part is eliminated once";
  if (setup.hf.method == HfMethod::active_set && stiffness_scales(setup.scene))
    return "all of A is scaled: two for the sweep of each group, columns of contact are kept";
  return "A depends on mu: one for each solve";
}

// Fitted to what `rbvi bench -bench_growth` measured on all cases, on meshes from 3 400 to 91 000
// dofs: right to a factor of two or so.
constexpr double of_number = 8;                ///< bytes
constexpr double mesh_bytes = 1500;            ///< of a problem, for a dof: mesh, numbers, terms
constexpr double used_once = 12e6;             ///< bytes: libraries, buffers
constexpr double matrix_entry = 3;             ///< numbers: in A and in the product of V
constexpr double mesh_seconds = 1.2e-5;        ///< for a dof
constexpr double sample_seconds = 3e-3;        ///< for a sample: its files, its contact
constexpr double of_dof = 1.5e-6;              ///< of a sample for a dof
constexpr double of_sum = 5e-6, of_map = 1e-5; ///< likewise where A is a sum of terms, or assembled
constexpr double written_seconds = 1.2e-7;     ///< for a number of a model and its fields
constexpr double solve_seconds = 5e-10;        ///< likewise, one right-hand side
constexpr double newton_solves = 80;           ///< by Nitsche's method, for a sample
constexpr double axis_points = 9;     ///< of the grid of the condensed operator, along an axis
constexpr double most_modes = 200;    ///< however many samples
constexpr double most_buffered = 1e7; ///< numbers: while fields are written
constexpr double most_queries = 200;  ///< random ones of the self-check
constexpr double for_others = 5;      ///< times as many where friction may have other answers
constexpr double for_others_in_space = 20;
constexpr double law_seconds = 6e-9;   ///< of a query, for the square of its multipliers
constexpr double scaled_solves = 2;    ///< of a sample where columns are kept
constexpr double query_seconds = 1e-4; ///< of a small model
constexpr double trace_seconds = 1e-9; ///< for a number of the modes on the contact region
constexpr double pair_seconds = 3e-10; ///< for the cube of the modes of a pair of spaces
constexpr double state_steps = 10;     ///< of contact that follows the displacement
constexpr double balance_solves = 5;   ///< of bodies that contact alone holds
constexpr const char *coarser_mesh = "a coarser mesh (-mesh_refine, -mesh)";

/// Nonzeros of a row of A, on average.
double row_entries(const Scene &scene) {
  const double neighbours =
      scene.dim == 2 ? (scene.degree == 1 ? 7 : 11.5) : (scene.degree == 1 ? 15 : 29);
  return scene.components * neighbours;
}

/// Entries of a factor of A by nested dissection.
double factor_entries(const Scene &scene, double dofs) {
  const double n = std::max(2.0, dofs);
  constexpr double in_space = 34; // CHOLMOD, solids from 10 000 to 130 000 dofs
  return scene.dim == 2 ? n * row_entries(scene) * std::log2(n) : in_space * n * std::cbrt(n);
}

/// Seconds: in the plane entries are what costs, in space their products.
double factorisation_seconds(const Scene &scene, double dofs) {
  constexpr double in_plane = 1e-8, in_space = 2.2e-10;
  return factor_entries(scene, dofs) * (scene.dim == 2 ? in_plane : in_space * std::sqrt(dofs));
}

double largest(MPI_Comm comm, double value) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, comm);
  return value;
}

double snapshot_seconds(const Scene &scene, const RunSizes &size, double samples) {
  const double of_group = std::ceil(samples * size.group / size.ranks),
               factor = factor_entries(scene, size.dofs),
               factorisation = factorisation_seconds(scene, size.dofs);
  if (!size.eliminated && stiffness_scales(scene) && size.multipliers > 0)
    return 2 * factorisation + size.multipliers * factor * column_seconds +
           of_group * (scaled_solves * solve_seconds * factor +
                       law_seconds * size.multipliers * size.multipliers);
  const bool varies = !constant_stiffness(scene),
             assembled = !split_sum(scene.a, scene.parameters).mapped.empty();
  const double of_a = varies ? (assembled ? of_map : of_sum) : 0;
  return factorisation +
         of_group *
             (sample_seconds +
              size.balances * (size.dofs * (of_dof + of_a) + size.solves * solve_seconds * factor +
                               (varies && !size.eliminated ? factorisation : 0)));
}

/// The stage that takes most on a node, its bytes there, and what makes it smaller.
struct LargestStage {
  std::string name;
  double bytes = 0;
  const char *smaller = "";
};

LargestStage largest_stage(const Foresight &foreseen, const std::vector<StageTable> &stages,
                           int ranks) {
  LargestStage most;
  for (const StageTable &table : stages)
    for (const StageRow &row : table) {
      const auto found = foreseen.find(row.stage.text);
      if (found == foreseen.end() || !will_run(table, row.stage)) continue;
      const double bytes = found->second.first + (ranks - 1) * found->second.others;
      if (bytes > most.bytes) most = {row.stage.text, bytes, found->second.smaller};
    }
  return most;
}

} // namespace

StageTable preparation_stages(const Setup &setup, std::size_t training, const Groups &groups,
                              const SweepReport *sweep) {
  StageTable rows{
      {stage::mesh, mesh_text(setup.mesh, setup.scene)},
      {StageName("factorisations"), factorisation_text(setup), StageKind::part},
      snapshot_row(training, groups, sweep),
      {stage::distributed_mesh, "for the reduction on all ranks"},
  };
  if (groups.count() == 1)
    rows.back() = {stage::distributed_mesh, "the one group holds all ranks", StageKind::skipped};
  return rows;
}

StageTable closing_stages() {
  return {{stage::writing, "model.h5, model.fields.h5, samples.csv"},
          {StageName("reconstruction"), "online, only when asked", StageKind::skipped}};
}

void print_stages(const std::vector<StageTable> &tables, const Foresight &foreseen) {
  constexpr double megabyte = 1e6;
  const auto number = [](const char *format, double value) {
    return value > 0 ? formatted(format, value) : std::string();
  };
  const auto print = [](const char *stage, const std::array<std::string, 4> &numbers,
                        const std::string &what) {
    std::printf("  %-22s %8s %9s %6s %7s  %s\n", stage, numbers[0].c_str(), numbers[1].c_str(),
                numbers[2].c_str(), numbers[3].c_str(), what.c_str());
  };
  std::printf("%-24s %8s %9s %6s %7s  %s\n", "Stage", "seconds", "(planned)", "MB", "(plan)",
              "what");
  double seconds = 0, planned = 0, peak = 0;
  for (const StageTable &rows : tables)
    for (const StageRow &row : rows) {
      const bool skipped = row.kind == StageKind::skipped || row.kind == StageKind::nothing_to_do;
      const auto found = foreseen.find(row.stage.text);
      const Foreseen plan =
          found == foreseen.end() || row.kind == StageKind::skipped ? Foreseen{} : found->second;
      print(row.stage.text,
            {number("%.3f", row.seconds.value_or(0)), number("(%.2g)", plan.seconds),
             number("%.0f", row.peak / megabyte), number("(%.0f)", plan.first / megabyte)},
            (skipped ? "skipped: " : "") + row.what);
      seconds += row.seconds.value_or(0);
      planned += skipped ? 0 : plan.seconds;
      peak = std::max(peak, row.peak);
    }
  if (seconds + planned > 0)
    print("total",
          {number("%.3f", seconds), number("(%.2g)", planned), number("%.0f", peak / megabyte), ""},
          "");
}

RunSizes sizes_by_count(MPI_Comm world, const Groups &groups, const Setup &setup) {
  RunSizes size;
  size.ranks = ranks_of(world);
  size.group = ranks_of(groups.comm());
  size.dofs =
      static_cast<double>(count_nodes(world, setup.scene, setup.mesh)) * setup.scene.components;
  size.before = largest(world, resident_bytes());
  size.held = size.before + mesh_bytes * size.dofs;
  return size;
}

RunSizes sizes_of(MPI_Comm world, const Problem &problem, const HfOptions &options, RunSizes size) {
  size.held = largest(world, resident_bytes());
  size.dofs = problem.dofs().total_free;
  size.contact = problem.trace().size;
  size.multipliers = static_cast<double>(problem.dual_size());
  if (!problem.free_bodies().empty()) size.balances = balance_solves;
  size.solves = newton_solves;
  size.eliminated = !has_multipliers(problem.scene());
  if (size.eliminated) return size;
  const ContactCost cost = contact_cost(problem, options.samples);
  size.eliminated = eliminates(problem, options);
  size.solves = size.eliminated ? cost.eliminated : cost.condensed;
  return size;
}

namespace {

/// Those of degree below axis_points.
double grid_points(double axes) {
  double points = 1;
  for (double d = 1; d <= axes; ++d)
    points *= (axis_points - 1 + d) / d;
  return points;
}

/// Of the reduction.
ReductionSize reduction_size(const OfflineOptions &options, const std::vector<Mu> &training,
                             const RunSizes &run) {
  const Scene &scene = options.scene;
  const ParameterSpace &space = scene.parameters;
  const auto count = [](const auto &list) { return static_cast<double>(list.size()); };
  const double loads =
      separable_contact(scene) ? run.multipliers : std::max(run.contact, run.multipliers);
  ReductionSize size{.samples = count(training),
                     .dofs = run.dofs,
                     .contact = run.contact,
                     .multipliers = run.multipliers,
                     .ranks = static_cast<double>(run.ranks),
                     .axes = count(parameters_beside_common(scene.a, space)),
                     .points = grid_points(count(parameters_beside_common(scene.a, space))),
                     .square = std::pow(loads, 2),
                     .entries = run.dofs * row_entries(scene),
                     .factor = factor_entries(scene, run.dofs),
                     .loads = loads,
                     .factorisation = factorisation_seconds(scene, run.dofs),
                     .of_a = count(interpolated_samples(scene.a, space, training)),
                     .of_f = count(interpolated_samples(scene.f, space, training)),
                     .of_b = separable_contact(scene) ? 11 * count(training) * run.multipliers : 0};
  const ReductionWay &way = way_of(scene, options.reduce.multipliers.reduction);
  const Joining joining = way.joining(scene, options.reduce, size);
  size.joined = joining.functions;
  size.modes = std::min(size.dofs, std::min(size.samples, most_modes) + size.joined);
  size.terms = count(split_sum(scene.a, space).exact) + std::min(size.of_a, most_terms / 2);
  size.model =
      size.dofs * size.modes / size.ranks + size.terms * size.modes * size.modes + joining.stored;
  const double query = query_seconds + trace_seconds * size.contact * size.modes +
                       (way.law ? law_seconds * size.multipliers * size.multipliers : 0) +
                       (way.dual_basis && !way.law ? pair_seconds * std::pow(size.modes, 3) : 0);
  size.self_check = (most_queries + count(corners_and_faces(space))) * query * run.balances *
                    (!has_friction(scene) ? 1
                     : scene.dim == 2     ? for_others
                                          : for_others_in_space) *
                    (follows_state(scene) ? state_steps : 1);
  return size;
}

} // namespace

Foresight foresee(const OfflineOptions &options, const std::vector<Mu> &training,
                  const RunSizes &run) {
  const Scene &scene = options.scene;
  const ReductionSize size = reduction_size(options, training, run);
  const double held = run.held + used_once + (matrix_entry * size.entries / run.group) * of_number;
  Foresight all;
  const auto add = [&](StageName stage, const StageNeed &need, const char *smaller) {
    all.emplace(stage.text, Foreseen{held + of_number * need.on_first,
                                     held + of_number * need.numbers, need.seconds, smaller});
  };
  const double mesh = run.before + mesh_bytes * size.dofs;
  all[stage::mesh.text] = {mesh, mesh, mesh_seconds * size.dofs, coarser_mesh};
  const bool multigrid = run.eliminated && scene.components == 1;
  const double condensed = run.eliminated ? 0 : 2 * size.contact * size.contact;
  const double solved = size.factor * (multigrid ? 0.5 : 1) / run.group + condensed;
  add(stage::snapshots, {solved, solved, snapshot_seconds(scene, run, size.samples)},
      "more ranks for a solve (-sweep_ranks_per_solve), -hf_contact eliminated, or a coarser mesh "
      "(-mesh_refine, -mesh)");
  add(stage::distributed_mesh, {mesh_bytes / of_number * size.dofs}, coarser_mesh);
  for (const ReductionStage &stage : stages_of(scene, options.reduce))
    if (stage.need != nullptr) add(stage.name, stage.need(size), stage.smaller);
  const double fields = size.dofs * size.modes; // after the model of the first rank
  add(stage::writing,
      {fields / size.ranks, size.model + fields + std::min(2 * fields, most_buffered),
       written_seconds * (size.model + fields)},
      coarser_hats);
  return all;
}

NodeMemory room_for(MPI_Comm world) {
  const double resident = largest(world, resident_bytes());
  NodeMemory room = tightest_node(world);
  room.bytes += room.ranks * resident;
  return room;
}

std::string memory_text(const Foresight &foreseen, const std::vector<StageTable> &stages,
                        const NodeMemory &room) {
  const auto [stage, bytes, smaller] = largest_stage(foreseen, stages, room.ranks);
  std::string text = "The most memory that a stage takes is about " + bytes_text(bytes) +
                     " for the " + counted(room.ranks, "rank") + " of a node (" + stage + "), of " +
                     bytes_text(room.bytes);
  if (bytes > room.bytes) text.append(": it may not fit; smaller by ").append(smaller);
  return text;
}

void check_memory(const Foresight &foreseen, const std::vector<StageTable> &stages,
                  const NodeMemory &room) {
  const auto [stage, bytes, smaller] = largest_stage(foreseen, stages, room.ranks);
  constexpr double right_to = 2; // what is foreseen: more than that is refused
  if (bytes <= right_to * room.bytes) return;
  throw bad_input("the stage '" + stage + "' would take about " + bytes_text(bytes) + " for the " +
                  counted(room.ranks, "rank") + " of a node, where " + bytes_text(room.bytes) +
                  " can be had: use " + smaller);
}

} // namespace rbvi
