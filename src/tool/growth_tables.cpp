#include "rbvi/core/text.hpp"
#include "rbvi/tool/growth.hpp"

namespace rbvi {

namespace {

constexpr double megabyte = 1e6;

const std::vector<std::string> growth_columns{
    "scene",         "refine",          "nodes",          "dofs",           "multipliers",
    "ranks",         "ranks_per_solve", "samples",        "failed",         "modes",
    "contact_nodes", "sample_seconds",  "iterations",     "model_mb",       "fields_mb",
    "resident_mb",   "stage",           "seconds",        "cpu_max",        "cpu_sum",
    "memory_max_mb", "memory_sum_mb",   "messages",       "messages_max",   "sent_mb",
    "reductions",    "symbolic",        "factorisations", "factor_seconds", "solves",
    "solve_seconds", "cg_steps",        "assemblies",     "interpolations"};

std::string row(const GrowthRun &run, const std::string &stage, const RankCosts &cost) {
  const auto count = [](double value) { return formatted("%.0f", value); };
  const auto real = [](double value) { return formatted("%.6g", value); };
  const auto &[largest, sum] = cost;
  return table_line({run.scene,
                     count(run.refine),
                     count(run.nodes),
                     count(run.dofs),
                     count(run.multipliers),
                     count(run.ranks),
                     count(run.ranks_per_solve),
                     count(run.samples),
                     count(run.failed),
                     count(run.modes),
                     count(run.contact_nodes),
                     real(run.sample_seconds),
                     real(run.iterations),
                     real(run.model_bytes / megabyte),
                     real(run.fields_bytes / megabyte),
                     real(run.resident / megabyte),
                     stage,
                     real(largest.seconds),
                     real(largest.cpu),
                     real(sum.cpu),
                     real(largest.memory / megabyte),
                     real(sum.memory / megabyte),
                     count(sum.messages),
                     count(largest.messages),
                     real(sum.bytes / megabyte),
                     count(largest.reductions),
                     count(largest.symbolic),
                     count(largest.factorisations),
                     real(largest.factor_seconds),
                     count(largest.solves),
                     real(largest.solve_seconds),
                     count(largest.cg_steps),
                     count(largest.assemblies),
                     count(largest.interpolations)},
                    "", ",", "");
}

} // namespace

RankCosts total_cost(const GrowthRun &run) {
  RankCosts total;
  for (const auto &[name, cost] : run.stages)
    total = {total.largest + cost.largest, total.sum + cost.sum};
  return total;
}

std::string growth_csv(const std::vector<GrowthRun> &runs) {
  std::string text = table_line(growth_columns, "", ",", "");
  for (const GrowthRun &run : runs) {
    for (const auto &[name, cost] : run.stages)
      text += row(run, name, cost);
    text += row(run, "total", total_cost(run));
  }
  return text;
}

} // namespace rbvi
