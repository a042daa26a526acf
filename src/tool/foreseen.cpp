#include "rbvi/tool/foreseen.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/mor/high_fidelity_pair.hpp"
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
  return "A depends on mu: one for each solve";
}

// Fitted to what `rbvi bench -bench_growth` measured on all cases, on meshes from 3 400 to 91 000
// dofs: right to a factor of two or so.
constexpr double of_number = 8;          ///< bytes
constexpr double mesh_bytes = 1500;      ///< of a problem, for a dof: mesh, numbers, terms
constexpr double used_once = 12e6;       ///< bytes: libraries, buffers
constexpr double matrix_entry = 3;       ///< numbers: in A and in the product of V
constexpr double mesh_seconds = 5e-6;    ///< for a dof
constexpr double factor_seconds = 1e-8;  ///< for an entry of a factor
constexpr double solve_seconds = 5e-10;  ///< likewise, one right-hand side
constexpr double column_seconds = 2e-10; ///< likewise, of many at once
constexpr double newton_solves = 80;     ///< by Nitsche's method, for a sample
constexpr double at_once = 128;          ///< right-hand sides
constexpr double axis_points = 9;        ///< of the grid of the condensed operator
constexpr double most_terms = 100;       ///< of that operator; twice what A is interpolated by
constexpr double most_modes = 200;       ///< however many samples
constexpr double few_responses = 150;    ///< where those to answers alone join the modes
constexpr double most_buffered = 1e7;    ///< numbers: while fields are written
constexpr double moving_part = 1 / 8.0;  ///< of the multipliers, which a cone has hats for

/// Nonzeros of a row of A, on average.
double row_entries(const Scene &scene) {
  const double neighbours =
      scene.dim == 2 ? (scene.degree == 1 ? 7 : 11.5) : (scene.degree == 1 ? 15 : 29);
  return scene.components * neighbours;
}

/// Entries of a factor of A by nested dissection.
double factor_entries(const Scene &scene, double dofs) {
  const double n = std::max(2.0, dofs);
  return n * row_entries(scene) * (scene.dim == 2 ? std::log2(n) : std::cbrt(n));
}

double largest(MPI_Comm comm, double value) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, comm);
  return value;
}

/// Free parameters that A is sampled over.
int axes_of(const Scene &scene) {
  return static_cast<int>(parameters_beside_common(scene.a, scene.parameters).size());
}

bool condenses(const OfflineOptions &options) {
  return options.reduce.multipliers.reduction == MultiplierReduction::condensed;
}

/// Functions that join the modes: responses, or supremizers of as many generators.
double joining(const OfflineOptions &options, const RunSizes &size, double samples) {
  const Scene &scene = options.scene;
  const ReduceOptions &reduce = options.reduce;
  if (reduce.multipliers.reduction == MultiplierReduction::none) return 0;
  if (condenses(options)) {
    if (reduce.condensed.responses == 0) return 0;
    if (axes_of(scene) > 0)
      return size.contact * (split_sum(scene.a, scene.parameters).mapped.empty() ? 1 : 4);
    return size.contact * size.dofs > reduce.condensed.large_fields ? few_responses
                                                                    : size.contact / 2;
  }
  if (reduce.enrichment == Enrichment::decorrelated) return 0;
  const bool hats = reduce.cone.type >= ConeType::nodal;
  const double coarser = std::pow(2, scene.dim * reduce.cone.level);
  return std::min(hats ? size.multipliers * moving_part / coarser : samples, size.multipliers);
}

double snapshot_seconds(const Scene &scene, const RunSizes &size, double samples) {
  const bool each = !constant_stiffness(scene) && !size.eliminated;
  return std::ceil(samples * size.group / size.ranks) * factor_entries(scene, size.dofs) *
         (size.solves * solve_seconds + (each ? factor_seconds : 0));
}

const char *made_smaller_by(const std::string &stage) {
  if (stage == stage::mesh.text || stage == stage::distributed_mesh.text)
    return "a coarser mesh (-mesh_refine, -mesh)";
  if (stage == stage::snapshots.text)
    return "more ranks for a solve (-sweep_ranks_per_solve), -hf_contact eliminated, or a coarser "
           "mesh (-mesh_refine, -mesh)";
  if (stage == stage::condensation.text)
    return "-response_tolerance 0, -multiplier_reduction cone where there is no friction, or a "
           "coarser mesh (-mesh_refine, -mesh)";
  if (stage != stage::interpolation.text && stage != stage::pod.text)
    return "fewer samples (-train), -cone_level where multipliers have hat functions, or a coarser "
           "mesh (-mesh_refine, -mesh)";
  return "fewer samples (-train) or a coarser mesh (-mesh_refine, -mesh)";
}

/// The stage that takes most on a node, and its bytes there.
std::pair<std::string, double> largest_stage(const Foresight &foreseen,
                                             const std::vector<StageTable> &stages, int ranks) {
  std::pair<std::string, double> most{"", 0};
  for (const StageTable &table : stages)
    for (const StageRow &row : table) {
      const auto found = foreseen.find(row.stage.text);
      if (found == foreseen.end() || !will_run(table, row.stage)) continue;
      const double bytes = found->second.first + (ranks - 1) * found->second.others;
      if (bytes > most.second) most = {row.stage.text, bytes};
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
  double seconds = 0, peak = 0;
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
      peak = std::max(peak, row.peak);
    }
  if (seconds > 0)
    print("total", {formatted("%.3f", seconds), "", number("%.0f", peak / megabyte), ""}, "");
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
  size.solves = newton_solves;
  size.eliminated = !has_multipliers(problem.scene());
  if (size.eliminated) return size;
  const ContactCost cost = contact_cost(problem, options.samples);
  size.eliminated = eliminates(problem, options);
  size.solves = size.eliminated ? cost.eliminated : cost.condensed;
  return size;
}

Foresight foresee(const OfflineOptions &options, const std::vector<Mu> &training,
                  const RunSizes &size) {
  const Scene &scene = options.scene;
  const ParameterSpace &space = scene.parameters;
  const auto count = [](const auto &list) { return static_cast<double>(list.size()); };
  const double n = size.dofs, m = size.multipliers, c = size.contact, ranks = size.ranks;
  const double samples = count(training), joined = joining(options, size, samples);
  const double modes = std::min(n, std::min(samples, most_modes) + joined);
  const double entries = n * row_entries(scene), factor = factor_entries(scene, n);
  const double of_a = count(interpolated_samples(scene.a, space, training)),
               of_f = count(interpolated_samples(scene.f, space, training)),
               of_b = separable_contact(scene) ? 11 * samples * m : 0,
               terms = count(split_sum(scene.a, space).exact) + std::min(of_a, most_terms / 2);
  const int axes = axes_of(scene);
  const double points = std::pow(axis_points, axes), square = std::pow(std::max(c, m), 2);
  // Numbers of a rank: A^-1 of many right-hand sides, generators with their responses, the model.
  const auto columns = [&](double all) { return factor + 2 * n * std::min(at_once, all / ranks); };
  const double generators = columns(joined) + 5 * m * joined;
  const double model = n * modes / ranks + terms * modes * modes +
                       (condenses(options) ? square * std::min(points, most_terms) : 0);
  const double held = size.held + used_once + (matrix_entry * entries / size.group) * of_number;
  Foresight all;
  const auto each_rank = [&](StageName stage, double numbers, double seconds = 0) {
    all[stage.text] = {held + of_number * numbers, held + of_number * numbers, seconds};
  };
  const double mesh = size.before + mesh_bytes * n;
  all[stage::mesh.text] = {mesh, mesh, mesh_seconds * n};
  const bool multigrid = size.eliminated && scene.components == 1;
  each_rank(stage::snapshots,
            factor * (multigrid ? 0.5 : 1) / size.group + (size.eliminated ? 0 : 2 * c * c),
            snapshot_seconds(scene, size, samples));
  each_rank(stage::distributed_mesh, mesh_bytes / of_number * n);
  each_rank(stage::interpolation, 2 * ((of_a * entries / 2 + of_f * n) / ranks + of_b));
  each_rank(stage::pod, 4 * n * samples / ranks + 6 * samples * samples);
  each_rank(stage::condensation,
            columns(c) + (axes > 0 ? 6 : 2) * n * modes / ranks +
                square * (axes > 0 ? std::min(points, 3 * most_terms) : 3),
            axes > 0 ? 0 : factor * (factor_seconds + c / ranks * column_seconds));
  each_rank(stage::multipliers, 3 * m * m);
  each_rank(stage::cone, generators);
  each_rank(stage::riesz, generators);
  each_rank(stage::infsup_tolerance,
            iterates_constants(m, n) ? 4 * factor / ranks : factor + 4 * c * c);
  each_rank(stage::pga, generators + 1.5 * n * joined / ranks);
  each_rank(stage::contact_curve, 6 * m * samples * samples);
  each_rank(stage::projection, model);
  for (const StageName stage : {stage::self_check, stage::writing}) {
    each_rank(stage, n * modes / ranks); // and the whole model on the first rank, then its fields
    const bool writes = stage.text == stage::writing.text;
    all[stage.text].first =
        held +
        of_number * (model + (writes ? n * modes + std::min(2 * n * modes, most_buffered) : 0));
  }
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
  const auto [stage, bytes] = largest_stage(foreseen, stages, room.ranks);
  std::string text = "The most memory that a stage takes is about " + bytes_text(bytes) +
                     " for the " + counted(room.ranks, "rank") + " of a node (" + stage + "), of " +
                     bytes_text(room.bytes);
  if (bytes > room.bytes)
    text.append(": it may not fit; smaller by ").append(made_smaller_by(stage));
  return text;
}

void check_memory(const Foresight &foreseen, const std::vector<StageTable> &stages,
                  const NodeMemory &room) {
  const auto [stage, bytes] = largest_stage(foreseen, stages, room.ranks);
  constexpr double right_to = 2; // what is foreseen: more than that is refused
  if (bytes <= right_to * room.bytes) return;
  throw bad_input("the stage '" + stage + "' would take about " + bytes_text(bytes) + " for the " +
                  counted(room.ranks, "rank") + " of a node, where " + bytes_text(room.bytes) +
                  " can be had: use " + made_smaller_by(stage));
}

} // namespace rbvi
