// Run time against error: every way to answer a query, measured on the same parameters on one rank.
#pragma once

#include "rbvi/fem/problem.hpp"
#include "rbvi/model/model.hpp"
#include "rbvi/sweep/sweep.hpp"

#include <functional>
#include <string>
#include <vector>

namespace rbvi {

/// One row: seconds per query, and relative errors (u in V, lambda in W) against the active_set
/// solutions, `outputs` the largest of any output, see largest_output_error(). Negative
/// errors: not applicable.
struct BenchRow {
  std::string method, includes;
  int queries = 0;
  double median = 0, slow = 0; ///< seconds; `slow`: 95 % of the queries are faster
  double u_mean = -1, u_max = -1, lambda_mean = -1, lambda_max = -1, outputs_max = -1;
  double offline = 0; ///< seconds before the first query
};

/// The outputs of samples.
std::vector<Outputs> outputs_of(const std::vector<Sample> &samples);

/// Seconds of `answer` for each mu.
std::vector<double> seconds_each(const std::vector<Mu> &set,
                                 const std::function<void(const Mu &)> &answer);

/// The value that a fraction of `values` does not exceed. Throws failure if there is none.
double quantile(std::vector<double> values, double fraction);

/// What a high-fidelity solve starts from: the active set of the one before, or none.
enum class From { last, cold };

/// High-fidelity solves at the first `count` truths; where one fails, a row without queries that
/// says why. Collective on the problem's communicator, as are the next three.
BenchRow bench_solver(Problem &problem, const HfOptions &options, const std::vector<Sample> &truths,
                      std::size_t count, From from);

/// The parts of an active_set solve that starts from the active set of the truth: assembly,
/// factorisation, two linear solves, and those with columns and LCP.
std::vector<BenchRow> bench_parts(Problem &problem, const std::vector<Sample> &truths);
/// Where contact follows the displacement: the iterations on a compliance that is there, from rest
/// and from the nearest of the truths before, and one linear solve.
std::vector<BenchRow> bench_iterations(Problem &problem, const std::vector<Sample> &truths);

/// The method `vi` against active_set, both on a problem with vertex quadrature.
BenchRow bench_vi(Problem &lumped, const std::vector<Mu> &set);

/// Interpolation of the snapshots, fields and multipliers.
BenchRow bench_interpolation(Problem &problem, const std::vector<Sample> &snapshots,
                             const std::vector<Sample> &truths);

/// The model without and with outputs and reconstruction, smaller pairs (where b is scaled only)
/// and decorrelated ones. Collective on the problem's communicator. `offline`: seconds.
std::vector<BenchRow> bench_models(Problem &problem, const ReducedModel &model,
                                   const std::vector<Sample> &truths, double offline);

} // namespace rbvi
