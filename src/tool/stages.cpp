#include "rbvi/tool/stages.hpp"

#include "rbvi/core/text.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/scaled_part.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

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

} // namespace rbvi
