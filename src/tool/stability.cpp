#include "verify.hpp"

#include "rbvi/par/collective.hpp"
#include "rbvi/study/stability_report.hpp"
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

/// What the points of a set are.
const char *kind_of(const std::vector<ContactPoint> &set) {
  return set.front().state.displacement.size() > 0 ? "pairs of mu and step" : "mu";
}

/// The number of each point among those of its mu; none of scenes without states.
std::vector<double> steps_of(const std::vector<ContactPoint> &set) {
  std::vector<double> steps;
  for (std::size_t k = 0; k < set.size() && set[k].state.displacement.size() > 0; ++k)
    steps.push_back(k > 0 && set[k].mu == set[k - 1].mu ? steps.back() + 1 : 0);
  return steps;
}

void write_constants(const fs::path &path, const ParameterSpace &space,
                     const std::vector<ContactPoint> &set, const std::vector<InfSup> &constants) {
  Table table;
  std::vector<Mu> mu;
  for (const ContactPoint &at : set)
    mu.push_back(at.mu);
  table.add(space, mu);
  if (const std::vector<double> steps = steps_of(set); !steps.empty()) table.add("step", steps);
  table.add("beta_hf", column(constants, &InfSup::hf));
  table.add("beta_dec", column(constants, &InfSup::dec));
  table.add("beta_on", column(constants, &InfSup::on));
  table.add("beta_off", column(constants, &InfSup::off));
  table.add("c_hf", column(constants, &InfSup::c_hf));
  table.write(path);
}

/// The smallest beta_off / beta_on.
double least_share(const std::vector<InfSup> &constants) {
  double share = std::numeric_limits<double>::infinity();
  for (const InfSup &c : constants)
    share = std::min(share, c.off / c.on);
  return share;
}

/// Of the validation set.
void report_constants(const std::vector<ContactPoint> &set, const std::vector<InfSup> &constants) {
  double ratio = std::numeric_limits<double>::infinity();
  for (const InfSup &c : constants)
    ratio = std::min(ratio, c.hf / c.c_hf);
  std::printf("Inf-sup constants over the span, smallest over %zu validation %s\n"
              "  beta_HF %.3e, beta_on %.3e, beta_off %.3e, beta_dec %.1e\n",
              constants.size(), kind_of(set), smallest(column(constants, &InfSup::hf)),
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

std::vector<ContactPoint> subset(const std::vector<ContactPoint> &set, int count) {
  std::vector<ContactPoint> result;
  for (const int p : spread(static_cast<int>(set.size()) - 1, count - 1))
    result.push_back(set[p]);
  return result;
}

/// Steps along the supremizers, and steps times parameters: bounds the time.
constexpr int most_steps = 200, most_steps_at_mu = 4000;

} // namespace

std::string no_constants(const ReducedModel &model) {
  if (model.contact.generators == 0) return "Nitsche's method has no multipliers";
  if (!model.contact.law || model.contact.law->on_functions()) return "";
  return "-multiplier_reduction condensed has no reduced pair of spaces (collocated has one)";
}

void check_stability(MPI_Comm world, Problem &problem, const ReducedModel &model,
                     const std::vector<ContactPoint> &training,
                     const std::vector<ContactPoint> &validation, const fs::path &out) {
  const bool scaled = model.contact.b.size() == 1;
  const StabilityCheck check = make_stability_check(problem, model);
  const std::vector<InfSup> constants = infsup_over(world, problem, check, validation, scaled);
  std::vector<ContactPoint> all = training;
  all.insert(all.end(), validation.begin(), validation.end());
  // Where there is a B for every step, the supremizers are chosen over the pairs of training.
  const bool follows = training.front().state.displacement.size() > 0;
  const std::vector<InfSup> of_training =
      follows ? infsup_over(world, problem, check, training, scaled) : std::vector<InfSup>{};
  const BoundCheck bound = check_bound(world, problem, check, all);
  // Where b is only scaled every mu has the same ratios.
  const std::vector<ContactPoint> different =
      scaled ? std::vector<ContactPoint>{weakest_form(problem, all)} : all;
  const int steps = std::min(model.body.supremizers, most_steps);
  const std::vector<StabilityRow> rows =
      stability_along(world, problem, check, subset(different, most_steps_at_mu / (1 + steps)),
                      spread(model.body.supremizers, steps));
  const int fewest = fewest_supremizers(world, problem, check, different, 0.9);
  collectively(world, [&] {
    if (rank_of(world) != 0) return;
    const ParameterSpace &space = problem.scene().parameters;
    write_constants(out / "infsup.csv", space, validation, constants);
    report_constants(validation, constants);
    if (follows) {
      write_constants(out / "infsup_training.csv", space, training, of_training);
      std::printf("  beta_off / beta_on at least %.3f over %zu of training, %.3f over %zu of "
                  "validation\n",
                  least_share(of_training), of_training.size(), least_share(constants),
                  constants.size());
    }
    write_stability(out / "stability.csv", rows);
    report_steps(rows);
    std::printf("  beta_off over its bound sqrt(1 - sigma^2) beta_on: at least %.6f, %d exceptions "
                "among %zu training and validation %s\n",
                bound.smallest, bound.exceptions, all.size(), kind_of(all));
    if (fewest >= 0)
      std::printf("  fewest supremizers with beta_off >= 0.9 beta_on at all of them: %d of %d\n",
                  fewest, model.body.supremizers);
    else
      std::printf("  all %d supremizers leave beta_off < 0.9 beta_on somewhere: lower "
                  "-pga_tolerance\n",
                  model.body.supremizers);
  });
}

} // namespace rbvi
