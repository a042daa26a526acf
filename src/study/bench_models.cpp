// The rows of reduced models: several pairs (N, R), enriched and not.
#include "rbvi/study/bench.hpp"
#include "rbvi/study/errors.hpp"
#include "rbvi/study/output_errors.hpp"

#include <algorithm>

namespace rbvi {

namespace {

constexpr int passes = 5; ///< over the whole set: a query is much shorter than a high-fidelity one

BenchRow named_row(const ReducedModel &model) {
  BenchRow row;
  row.method = "reduced (" + std::to_string(model.body.modes) + "+" +
               std::to_string(model.body.supremizers) + ", " +
               std::to_string(model.contact.generators) + ")";
  return row;
}

BenchRow timed_model(const ReducedModel &model, const std::string &includes,
                     const std::vector<Mu> &set,
                     const std::function<void(const Mu &, OnlineSolver &)> &answer) {
  OnlineSolver solver(model);
  std::vector<double> seconds;
  for (int pass = 0; pass <= passes; ++pass) {
    const auto measured = seconds_each(set, [&](const Mu &mu) { answer(mu, solver); });
    if (pass > 0) seconds.insert(seconds.end(), measured.begin(), measured.end());
  }
  BenchRow row = named_row(model);
  row.includes = includes;
  row.queries = static_cast<int>(seconds.size());
  row.median = quantile(seconds, 0.5);
  row.slow = quantile(seconds, 0.95);
  return row;
}

void answer_alone(const Mu &mu, OnlineSolver &solver) {
  solver.solve(mu, true);
}

void store(const ModelErrors &errors, BenchRow &row) {
  row.u_mean = errors.u.mean();
  row.u_max = errors.u.maxCoeff();
  row.lambda_mean = errors.lambda.mean();
  row.lambda_max = errors.lambda.maxCoeff();
}

/// The pairs of the published tables that the model contains, and two smaller ones; all of the dual
/// basis each time where it has free modes or is nodal.
std::vector<std::pair<int, int>> pairs_of(const ReducedModel &model) {
  std::vector<std::pair<int, int>> pairs;
  for (const auto &[n, r] : {std::pair{5, 10}, {10, 20}, {19, 50}, {51, 70}}) {
    const bool whole = model.contact.free_modes > 0 || model.contact.law;
    const int generators = whole ? model.contact.generators : std::min(r, model.contact.generators);
    if (n < model.body.modes) pairs.emplace_back(n, generators);
  }
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

} // namespace

std::vector<BenchRow> bench_models(Problem &problem, const ReducedModel &model,
                                   const std::vector<Sample> &samples, double offline) {
  const Truths truths = make_truths(problem, model, samples);
  std::vector<BenchRow> rows;
  const auto add = [&](const ReducedModel &part, const Matrix &embedding) {
    const ModelErrors errors = model_errors(part, embedding, truths, problem.w_product());
    if (errors.failed > 0) {
      BenchRow row = named_row(part);
      row.includes = "no answer at " + std::to_string(errors.failed) + " of " +
                     std::to_string(errors.u.size());
      rows.push_back(row);
      return;
    }
    rows.push_back(timed_model(part, "coefficients", truths.mu, answer_alone));
    store(errors, rows.back());
    rows.back().outputs_max =
        largest_output_error(reduced_outputs(part, truths.mu), outputs_of(samples));
  };
  for (const auto &[n, r] : pairs_of(model)) {
    if (knows_enriched_pairs(model)) {
      const SubModel pair = enriched_pair(model, n, r);
      add(pair.model, pair.embedding);
    }
    add(leading(model, n, r), {});
  }
  if (model.body.supremizers > 0)
    add(leading(model, model.body.modes, model.contact.generators), {});
  add(model, {});
  const BenchRow whole = rows.back();
  const auto with = [&](const std::string &includes, const auto &answer) {
    BenchRow row = timed_model(model, includes, truths.mu, answer);
    row.u_mean = whole.u_mean;
    row.u_max = whole.u_max;
    row.lambda_mean = whole.lambda_mean;
    row.lambda_max = whole.lambda_max;
    row.outputs_max = whole.outputs_max;
    rows.push_back(row);
  };
  if (whole.queries > 0) { // it has an answer everywhere
    with("outputs",
         [](const Mu &mu, OnlineSolver &solver) { solver.outputs(mu, solver.solve(mu, true)); });
    with("outputs, field", [](const Mu &mu, OnlineSolver &solver) {
      const ReducedAnswer answer = solver.solve(mu, true);
      solver.outputs(mu, answer);
      solver.field(answer);
    });
  }
  for (BenchRow &row : rows)
    if (row.u_mean >= 0) row.offline = offline;
  return rows;
}

} // namespace rbvi
