// rbvi offline: from a case file to a model file.
#include "rbvi/core/error.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/tool/commands.hpp"
#include "rbvi/tool/tables.hpp"
#include "rbvi/tool/workspace.hpp"

#include <cstdio>
#include <fstream>

namespace rbvi {

namespace {

void print_plan(const ToolOptions &options, std::size_t training, int groups) {
  const Scene &scene = options.scene;
  const auto line = [](const char *stage, const std::string &what) {
    std::printf("  %-22s %s\n", stage, what.c_str());
  };
  std::printf("Plan for scene %s\n", scene.name.c_str());
  line("snapshots", std::to_string(training) + " high-fidelity solves on " +
                        std::to_string(groups) + " groups of " +
                        std::to_string(options.ranks_per_solve) + " ranks");
  line("interpolation",
       "A, B, F and G over the training set; a term that only scales stops at rank 1");
  line("POD",
       "displacements, to a relative error of " + short_number(options.reduce.pod.tolerance));
  line("cone", std::string(options.reduce.cone.type == ConeType::mcpg ? "mcpg" : "cpg") +
                   " for the multipliers, to " + short_number(options.reduce.cone.tolerance));
  line("PGA", options.reduce.pga.tolerance > 0
                  ? "supremizers until sigma <= " + short_number(options.reduce.pga.tolerance)
                  : "supremizers until beta_off >= " + short_number(options.reduce.pga.stability) +
                        " beta_on");
  if (!scene.f) line("load vector", "skipped: the scene has no load");
  line("tangential multipliers", "skipped: the scene has no friction");
  line("reconstruction", "skipped: online, only when asked");
}

std::map<std::string, std::string> model_settings(const ToolOptions &options, std::size_t samples) {
  return {{"training", options.train},
          {"samples", std::to_string(samples)},
          {"mesh_refine", std::to_string(options.mesh.refine)},
          {"pod_tolerance", short_number(options.reduce.pod.tolerance)},
          {"cone_type", options.reduce.cone.type == ConeType::mcpg ? "mcpg" : "cpg"},
          {"cone_tolerance", short_number(options.reduce.cone.tolerance)},
          {"cone_feasibility", short_number(options.reduce.cone.feasibility)},
          {"pga_tolerance", short_number(options.reduce.pga.tolerance)},
          {"pga_beta_fraction", short_number(options.reduce.pga.stability)},
          {"eim_tolerance", short_number(options.reduce.eim.tolerance)}};
}

void print_sweep(const Sweep &sweep, const ParameterSpace &space) {
  const SweepReport &report = sweep.report;
  std::printf("Snapshots: %d solved, %d reused, %zu failed; median %.1f ms each\n", report.solved,
              report.reused, report.failed.size(), 1e3 * report.seconds_per_solve);
  for (const auto &[mu, reason] : report.failed)
    std::printf("  failed at %s: %s\n", describe(space, mu).c_str(), reason.c_str());
}

std::string eim_summary(const char *name, const Eim &eim) {
  return std::string("  ") + name + ": rank " + std::to_string(eim.size()) + ", error " +
         short_number(eim.error.empty() ? 0 : eim.error.back()) + " (" + eim.reason + ")\n";
}

void print_bases(const ReducedBases &bases, const AffineOperators &affine) {
  std::printf("Interpolation\n%s%s%s%s", eim_summary("A", affine.a).c_str(),
              eim_summary("B", affine.b).c_str(),
              affine.f.size() > 0 ? eim_summary("F", affine.f).c_str() : "  F: none\n",
              eim_summary("G", affine.g).c_str());
  std::printf("Bases: N = %d modes (e_POD %.2e), R = %td generators (error %.2e, %s),\n"
              "       S = %d supremizers (sigma %.2e, %s)\n",
              bases.modes, bases.pod.error[static_cast<std::size_t>(bases.modes)],
              bases.cone.basis.generators.cols(), bases.cone.history.error.back(),
              bases.cone.history.reason.c_str(), bases.supremizers, bases.pga.sigma.back(),
              bases.pga.reason.c_str());
}

void print_times(const StageTimes &times) {
  double total = 0;
  std::printf("Stage                    seconds\n");
  for (const auto &[stage, seconds] : times) {
    std::printf("  %-22s %8.3f\n", stage.c_str(), seconds);
    total += seconds;
  }
  std::printf("  %-22s %8.3f\n", "total", total);
}

} // namespace

void command_offline(const ToolOptions &options) {
  const MPI_Comm world = PETSC_COMM_WORLD;
  const std::vector<Mu> training = parse_set(options.scene.parameters, options.train);
  const Groups groups(world, options.ranks_per_solve);
  int rank = 0;
  MPI_Comm_rank(world, &rank);
  if (rank == 0) print_plan(options, training.size(), groups.count());
  if (options.plan) return;
  if (options.out.empty()) throw bad_input("no run directory is named: use -out run/NAME");

  StageTimes times;
  Sweep sweep;
  Workspace work(world, groups, options, times);
  {
    const Stage stage("snapshots", times);
    sweep = run_sweep(world, groups, work.group_problem(), options.hf, training,
                      options.out / "samples");
  }
  if (rank == 0) print_sweep(sweep, options.scene.parameters);
  if (sweep.samples.empty()) throw failure("no sample succeeded: see the reasons above");

  Problem &problem = work.world_problem(times);
  std::vector<Mu> solved;
  for (const Sample &sample : sweep.samples)
    solved.push_back(sample.mu);
  AffineOperators affine;
  {
    const Stage stage("interpolation", times);
    affine = separate(problem, solved, options.reduce.eim);
  }
  const ReducedBases bases =
      build_bases(problem, sweep.samples, options.reduce, affine.b.size() == 1, times);
  if (rank == 0) print_bases(bases, affine);
  ReducedModel model;
  {
    const Stage stage("projection", times);
    model = project(problem, sweep.samples, affine, bases);
  }
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
  if (rank == 0) {
    print_times(times);
    std::printf("Model: %s\n", (options.out / "model.h5").c_str());
  }
}

} // namespace rbvi
