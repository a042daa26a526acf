#include "rbvi/core/text.hpp"
#include "rbvi/tool/growth.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <set>

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

/// What a table shows of the runs, and how.
struct Shown {
  const char *name;
  const char *format;
  bool grows; ///< its exponent is told
  std::function<double(const RankCosts &)> of;
};

const std::vector<Shown> &shown() {
  static const std::vector<Shown> all{
      {"seconds", "%.3g", true, [](const RankCosts &c) { return c.largest.seconds; }},
      {"CPU seconds", "%.3g", true, [](const RankCosts &c) { return c.sum.cpu; }},
      {"MB per rank", "%.0f", true, [](const RankCosts &c) { return c.largest.memory / megabyte; }},
      {"messages", "%.0f", false, [](const RankCosts &c) { return c.sum.messages; }},
      {"reductions", "%.0f", false, [](const RankCosts &c) { return c.largest.reductions; }},
      {"factorisations", "%.0f", false,
       [](const RankCosts &c) { return c.largest.factorisations; }},
      {"solves", "%.0f", false, [](const RankCosts &c) { return c.largest.solves; }},
      {"CG steps", "%.0f", false, [](const RankCosts &c) { return c.largest.cg_steps; }}};
  return all;
}

using Runs = std::vector<const GrowthRun *>;

/// The stage of each run; null where it did not run.
std::vector<const RankCosts *> stage_of(const Runs &runs, const std::string &name) {
  std::vector<const RankCosts *> found;
  for (const GrowthRun *run : runs) {
    const auto at = std::find_if(run->stages.begin(), run->stages.end(),
                                 [&](const auto &stage) { return stage.first == name; });
    found.push_back(at == run->stages.end() ? nullptr : &at->second);
  }
  return found;
}

std::string exponent_text(const std::optional<double> &exponent) {
  return exponent ? formatted("%.2f", *exponent) : "";
}

/// The cells of one stage behind its name. `held`: bytes of a rank before the first run.
std::vector<std::string> stage_cells(const Runs &runs, const std::vector<const RankCosts *> &costs,
                                     double held) {
  std::vector<std::string> cells;
  for (const Shown &what : shown()) {
    std::vector<std::string> values;
    std::vector<double> x, y;
    const bool memory = std::string(what.name) == "MB per rank";
    for (std::size_t i = 0; i < runs.size(); ++i) {
      values.push_back(costs[i] == nullptr ? "-" : formatted(what.format, what.of(*costs[i])));
      if (costs[i] == nullptr) continue;
      x.push_back(runs[i]->dofs);
      y.push_back(what.of(*costs[i]) - (memory ? held / megabyte : 0));
    }
    cells.push_back(joined(values, " / "));
    if (what.grows) cells.push_back(exponent_text(growth_exponent(x, y)));
  }
  return cells;
}

std::string table(const Runs &runs, double held) {
  std::vector<std::string> header{"stage"};
  for (const Shown &what : shown()) {
    header.emplace_back(what.name);
    if (what.grows) header.emplace_back("exponent");
  }
  std::string text = table_line(header, "| ", " | ", " |") +
                     table_line(std::vector<std::string>(header.size(), "---"), "|", "|", "|");
  std::vector<std::string> names;
  for (const GrowthRun *run : runs)
    for (const auto &[name, cost] : run->stages)
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  const auto add = [&](const std::string &name, const std::vector<const RankCosts *> &costs) {
    std::vector<std::string> cells = stage_cells(runs, costs, held);
    cells.insert(cells.begin(), name);
    text += table_line(cells, "| ", " | ", " |");
  };
  for (const std::string &name : names)
    add(name, stage_of(runs, name));
  std::vector<RankCosts> totals;
  for (const GrowthRun *run : runs)
    totals.push_back(total_cost(*run));
  std::vector<const RankCosts *> all;
  for (const RankCosts &total : totals)
    all.push_back(&total);
  add("total", all);
  return text;
}

/// The line above a table: what else the runs were.
std::string facts(const Runs &runs) {
  const auto over_runs = [&](const char *format,
                             const std::function<double(const GrowthRun &)> &of) {
    std::vector<std::string> values;
    for (const GrowthRun *run : runs)
      values.push_back(formatted(format, of(*run)));
    return joined(values, " / ");
  };
  return "dofs " + over_runs("%.0f", [](const GrowthRun &run) { return run.dofs; }) +
         ", multipliers " +
         over_runs("%.0f", [](const GrowthRun &run) { return run.multipliers; }) + ", modes " +
         over_runs("%.0f", [](const GrowthRun &run) { return run.modes; }) + "; a solve takes " +
         over_runs("%.3g", [](const GrowthRun &run) { return 1e3 * run.sample_seconds; }) +
         " ms and " + over_runs("%.3g", [](const GrowthRun &run) { return run.iterations; }) +
         " iterations (medians of " +
         over_runs("%.0f", [](const GrowthRun &run) { return run.samples; }) +
         " samples); model.h5 " +
         over_runs("%.2f", [](const GrowthRun &run) { return run.model_bytes / megabyte; }) +
         " MB, its fields " +
         over_runs("%.2f", [](const GrowthRun &run) { return run.fields_bytes / megabyte; }) +
         " MB.\n\n";
}

} // namespace

RankCosts total_cost(const GrowthRun &run) {
  RankCosts total;
  for (const auto &[name, cost] : run.stages)
    total = {total.largest + cost.largest, total.sum + cost.sum};
  return total;
}

std::optional<double> growth_exponent(const std::vector<double> &x, const std::vector<double> &y) {
  std::vector<double> log_x, log_y;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!(x[i] > 0) || !(y[i] > 0)) continue;
    log_x.push_back(std::log(x[i]));
    log_y.push_back(std::log(y[i]));
  }
  if (std::set<double>(log_x.begin(), log_x.end()).size() < 2) return {};
  const auto mean = [](const std::vector<double> &values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  };
  const double mean_x = mean(log_x), mean_y = mean(log_y);
  double xx = 0, xy = 0;
  for (std::size_t i = 0; i < log_x.size(); ++i) {
    xx += (log_x[i] - mean_x) * (log_x[i] - mean_x);
    xy += (log_x[i] - mean_x) * (log_y[i] - mean_y);
  }
  return xy / xx;
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

std::string growth_page(const std::vector<GrowthRun> &runs) {
  std::set<int> groupings;
  for (const GrowthRun &run : runs)
    groupings.insert(run.ranks_per_solve);
  std::string text =
      "# Growth with the mesh: " + runs.front().scene + ", " + counted(runs.front().ranks, "rank") +
      "\n\nExponents are those of dofs, of memory without the " +
      formatted("%.0f", runs.front().resident / megabyte) +
      " MB that a rank held before the first run. Seconds, MB, reductions, factorisations, "
      "solves and CG steps are the largest of a rank, CPU seconds and messages those "
      "of all ranks.\n";
  for (const int per_solve : groupings) {
    Runs of_grouping;
    for (const GrowthRun &run : runs)
      if (run.ranks_per_solve == per_solve) of_grouping.push_back(&run);
    text += "\n## " + counted(per_solve, "rank") + " per solve\n\n" + facts(of_grouping) +
            table(of_grouping, runs.front().resident);
  }
  return text;
}

} // namespace rbvi
