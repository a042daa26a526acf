#include "verify_stability.hpp"

#include "rbvi/check/stability_report.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/tool/tables.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

double smallest(const std::vector<double> &values) {
  return *std::min_element(values.begin(), values.end());
}

double largest(const std::vector<double> &values) {
  return *std::max_element(values.begin(), values.end());
}

void report_constants(const fs::path &path, const ParameterSpace &space, const std::vector<Mu> &set,
                      const std::vector<InfSup> &constants) {
  Table table;
  table.add(space, set);
  table.add("beta_hf", column(constants, &InfSup::hf));
  table.add("beta_dec", column(constants, &InfSup::dec));
  table.add("beta_on", column(constants, &InfSup::on));
  table.add("beta_off", column(constants, &InfSup::off));
  table.add("c_hf", column(constants, &InfSup::c_hf));
  table.write(path);
  double ratio = std::numeric_limits<double>::infinity();
  for (const InfSup &c : constants)
    ratio = std::min(ratio, c.hf / c.c_hf);
  std::printf("Inf-sup constants over the span, smallest over %zu validation mu\n"
              "  beta_HF %.3e, beta_on %.3e, beta_off %.3e, beta_dec %.1e\n",
              constants.size(), smallest(column(constants, &InfSup::hf)),
              smallest(column(constants, &InfSup::on)), smallest(column(constants, &InfSup::off)),
              smallest(column(constants, &InfSup::dec)));
  std::printf("  c_HF at most %.3e, beta_HF / c_HF at least %.3e\n",
              largest(column(constants, &InfSup::c_hf)), ratio);
}

void write_stability(const fs::path &path, const std::vector<StabilityRow> &rows) {
  Table table;
  table.add("S", column(rows, &StabilityRow::supremizers));
  table.add("sigma_max", column(rows, &StabilityRow::sigma));
  table.add("condition_max", column(rows, &StabilityRow::condition));
  table.add("classic_min", column(rows, &StabilityRow::classic));
  table.add("bound_min", column(rows, &StabilityRow::bound));
  table.add("ratio_min", column(rows, &StabilityRow::ratio));
  table.add("beta_min", column(rows, &StabilityRow::beta));
  table.add("exceptions", column(rows, &StabilityRow::exceptions));
  table.write(path);
}

/// From how many supremizers on each bound says something.
void report_steps(const std::vector<StabilityRow> &rows) {
  int exceptions = 0, classic = -1;
  for (const StabilityRow &row : rows) {
    exceptions += row.exceptions;
    if (classic < 0 && row.condition < 1) classic = row.supremizers;
  }
  std::printf("  along %d supremizers: %d exceptions from beta_off >= sqrt(1 - sigma^2) beta_on; ",
              rows.back().supremizers, exceptions);
  if (classic >= 0)
    std::printf("(2.23) holds from %d on\n", classic);
  else
    std::printf("(2.23) never holds\n");
}

/// 0 to `last` in about `count` equal steps, both ends included.
std::vector<int> spread(int last, int count) {
  std::set<int> values{0};
  for (int k = 1; k <= count; ++k)
    values.insert(static_cast<int>(static_cast<long>(k) * last / count));
  return {values.begin(), values.end()};
}

std::vector<Mu> subset(const std::vector<Mu> &set, int count) {
  std::vector<Mu> result;
  for (const int p : spread(static_cast<int>(set.size()) - 1, count - 1))
    result.push_back(set[static_cast<std::size_t>(p)]);
  return result;
}

/// Steps along the supremizers, and steps times parameters: bounds the time.
constexpr int most_steps = 200, most_steps_at_mu = 4000;

} // namespace

std::string no_constants(const ReducedModel &model) {
  if (model.nitsche) return "Nitsche's method has no multipliers";
  if (!model.law || model.law->reduction == MultiplierReduction::collocated) return "";
  const auto kind = static_cast<std::size_t>(model.law->reduction);
  return "-multiplier_reduction " + multiplier_reduction_names()[kind] +
         " has no reduced pair of spaces (collocated has one)";
}

void check_stability(MPI_Comm world, Problem &problem, const ReducedModel &model,
                     const std::vector<Mu> &training, const std::vector<Mu> &validation,
                     const fs::path &out) {
  const bool scaled = model.b.size() == 1;
  const StabilityCheck check = make_stability_check(problem, model);
  const std::vector<InfSup> constants = infsup_over(world, problem, check, validation, scaled);
  std::vector<Mu> all = training;
  all.insert(all.end(), validation.begin(), validation.end());
  const BoundCheck bound = check_bound(world, problem, check, all);
  // Where b is only scaled every mu has the same ratios.
  const std::vector<Mu> different = scaled ? std::vector<Mu>{weakest_form(problem, all)} : all;
  const int steps = std::min(model.supremizers, most_steps);
  const std::vector<StabilityRow> rows =
      stability_along(world, problem, check, subset(different, most_steps_at_mu / (1 + steps)),
                      spread(model.supremizers, steps));
  const int fewest = fewest_supremizers(world, problem, check, different, 0.9);
  collectively(world, [&] {
    if (rank_of(world) != 0) return;
    report_constants(out / "infsup.csv", problem.scene().parameters, validation, constants);
    write_stability(out / "stability.csv", rows);
    report_steps(rows);
    std::printf("  beta_off over its bound sqrt(1 - sigma^2) beta_on: at least %.6f, %d exceptions "
                "among %zu training and validation mu\n",
                bound.smallest, bound.exceptions, all.size());
    if (fewest >= 0)
      std::printf("  fewest supremizers with beta_off >= 0.9 beta_on at all of them: %d of %d\n",
                  fewest, model.supremizers);
    else
      std::printf("  all %d supremizers leave beta_off < 0.9 beta_on somewhere: lower "
                  "-pga_tolerance\n",
                  model.supremizers);
  });
}

} // namespace rbvi
