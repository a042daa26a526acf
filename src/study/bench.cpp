#include "rbvi/study/bench.hpp"

#include "rbvi/core/box.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/solve/methods.hpp"
#include "rbvi/study/errors.hpp"
#include "rbvi/study/interpolation.hpp"
#include "rbvi/study/output_errors.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

/// Errors of fields u and multipliers lambda, collected query by query.
class Errors {
public:
  explicit Errors(Problem &problem) : problem_(problem) {}

  void add(const Vector &u, const Vector &lambda, const Sample &truth) {
    u_.emplace_back(v_norm(u - truth.u), displacement_norm(problem_, truth.mu, truth.u));
    lambda_.emplace_back(w_norm(lambda - truth.lambda), w_norm(truth.lambda));
  }
  void store(BenchRow &row) const {
    const Vector u = over_sizes(u_), lambda = over_sizes(lambda_);
    row.u_mean = u.mean();
    row.u_max = u.maxCoeff();
    row.lambda_mean = lambda.mean();
    row.lambda_max = lambda.maxCoeff();
  }

private:
  using Sized = std::vector<std::pair<double, double>>; ///< errors, and what they are errors of
  static Vector over_sizes(const Sized &errors) {
    double largest = 0;
    for (const auto &[error, size] : errors)
      largest = std::max(largest, size);
    Vector result(std::ssize(errors));
    for (Index p = 0; p < result.size(); ++p) {
      const auto &[error, size] = errors[p];
      result[p] = relative(error, size, largest);
    }
    return result;
  }
  double v_norm(const Vector &natural) {
    const Handle<Vec> u = from_natural(problem_.dofs(), natural);
    Handle<Vec> vu;
    RBVI_CALL(VecDuplicate(u.get(), vu.put()));
    RBVI_CALL(MatMult(problem_.v_product(), u.get(), vu.get()));
    PetscScalar square = 0;
    RBVI_CALL(VecDot(u.get(), vu.get(), &square));
    return std::sqrt(square);
  }
  double w_norm(const Vector &lambda) const {
    return std::sqrt(lambda.dot(problem_.w_product() * lambda));
  }

  Problem &problem_;
  Sized u_, lambda_;
};

BenchRow timed_row(std::string method, std::string includes, const std::vector<double> &seconds) {
  BenchRow row;
  row.method = std::move(method);
  row.includes = std::move(includes);
  row.queries = static_cast<int>(seconds.size());
  row.median = quantile(seconds, 0.5);
  row.slow = quantile(seconds, 0.95);
  return row;
}

const std::string from_rest = "from rest", from_answer = "from the answer before";

std::string solver_name(const Problem &problem, const HfOptions &options, bool at_rest) {
  const std::string &from = at_rest ? from_rest : from_answer;
  if (!has_multipliers(problem.scene())) return "nitsche " + from;
  switch (options.method) {
  case HfMethod::active_set:
    return "active_set " + from;
  case HfMethod::uzawa:
    return options.uzawa.accelerated ? "uzawa accelerated" : "uzawa fixed step";
  case HfMethod::vi:
    return "vi on the lumped scene";
  }
  return "";
}

/// sum += weight * outputs, quantities alone.
void add_outputs(double weight, const Outputs &outputs, Outputs &sum) {
  for (const OutputColumn &column : output_columns())
    if (const std::optional<double> value = column.of(outputs);
        value && column.kind == OutputKind::quantity)
      sum.*column.value = (sum.*column.value).value_or(0) + weight * *value;
}

} // namespace

std::vector<double> seconds_each(const std::vector<Mu> &set,
                                 const std::function<void(const Mu &)> &answer) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> seconds;
  for (const Mu &mu : set) {
    const auto start = Clock::now();
    answer(mu);
    seconds.push_back(std::chrono::duration<double>(Clock::now() - start).count());
  }
  return seconds;
}

std::vector<Outputs> outputs_of(const std::vector<Sample> &samples) {
  std::vector<Outputs> result;
  for (const Sample &sample : samples)
    result.push_back(sample.outputs);
  return result;
}

double quantile(std::vector<double> values, double fraction) {
  if (values.empty()) throw failure("no query was measured");
  std::sort(values.begin(), values.end());
  const double last = static_cast<double>(values.size() - 1);
  return values[static_cast<std::size_t>(std::ceil(fraction * last))];
}

BenchRow bench_solver(Problem &problem, const HfOptions &options, const std::vector<Sample> &truths,
                      std::size_t count, From from) {
  const bool cold = from == From::cold;
  HfOptions of_all = options;
  of_all.samples = cold ? 1 : static_cast<int>(count);
  HighFidelity solver(problem, of_all);
  Errors errors(problem);
  std::vector<Mu> set = parameters_of(truths);
  set.resize(std::min(count, set.size()));
  std::vector<HfSolution> answers;
  std::vector<Outputs> outputs;
  std::vector<double> seconds;
  try {
    seconds = seconds_each(set, [&](const Mu &mu) {
      if (cold) solver.forget();
      answers.push_back(solver.solve(mu));
    });
  } catch (const Error &error) {
    BenchRow row;
    row.method = solver_name(problem, options, cold);
    row.includes = std::string("no answer: ") + error.what();
    return row;
  }
  for (std::size_t p = 0; p < answers.size(); ++p) {
    errors.add(answers[p].u, answers[p].lambda, truths[p]);
    outputs.push_back(answers[p].outputs);
  }
  BenchRow row =
      timed_row(solver_name(problem, options, cold), "assembly, field, outputs", seconds);
  errors.store(row);
  row.outputs_max = largest_output_error(outputs, outputs_of(truths));
  return row;
}

std::vector<BenchRow> bench_parts(Problem &problem, const std::vector<Sample> &truths) {
  const Handle<KSP> ksp = make_direct_solver(problem.comm(), "hf_");
  const std::vector<std::string> names{"assembly", "factorisation", "two linear solves",
                                       "solves, columns and LCP"};
  std::vector<std::vector<double>> seconds(names.size());
  FactoredBody body(ksp.get(), problem.trace(),
                    constant_stiffness(problem.scene()) ? ColumnsLast::for_all_mu
                                                        : ColumnsLast::for_one_b);
  for (const Sample &truth : truths) {
    std::vector<double> at{MPI_Wtime()};
    const Operators &op = problem.assemble(truth.mu);
    at.push_back(MPI_Wtime());
    RBVI_CALL(KSPSetOperators(ksp.get(), op.a, op.a));
    RBVI_CALL(KSPSetUp(ksp.get()));
    at.push_back(MPI_Wtime());
    Handle<Vec> u;
    RBVI_CALL(VecDuplicate(op.f, u.put()));
    solve_linear(ksp.get(), op.f, u.get());
    solve_linear(ksp.get(), op.f, u.get());
    at.push_back(MPI_Wtime());
    body.set(op.a);
    solve_active_set(body, op, truth.lambda);
    at.push_back(MPI_Wtime());
    for (std::size_t k = 0; k < names.size(); ++k)
      seconds[k].push_back(at[k + 1] - at[k]);
  }
  std::vector<BenchRow> rows;
  for (std::size_t k = 0; k < names.size(); ++k)
    rows.push_back(timed_row("active_set: " + names[k], "this part alone", seconds[k]));
  return rows;
}

std::vector<BenchRow> bench_iterations(Problem &problem, const std::vector<Sample> &truths) {
  const Handle<KSP> ksp = make_direct_solver(problem.comm(), "hf_");
  FactoredBody body(ksp.get(), problem.trace(), ColumnsLast::for_all_mu);
  std::vector<double> linear;
  const auto seconds = [&](NonlinearMethod method, bool warm, bool timed) {
    NonlinearOptions options;
    options.method = method;
    std::vector<double> result;
    const ParameterSpace &space = problem.scene().parameters;
    Starts<Start> solved(space);
    for (std::size_t k = warm ? 1 : 0; k < truths.size(); ++k) {
      if (warm)
        solved.add(expand(space, truths[k - 1].mu),
                   {truths[k - 1].states.rightCols(1), truths[k - 1].lambda});
      Operators op = problem.assemble(truths[k].mu);
      RBVI_CALL(KSPSetOperators(ksp.get(), op.a, op.a));
      RBVI_CALL(KSPSetUp(ksp.get()));
      const Start *near = solved.nearest_added(op.mu);
      const Start start =
          near ? *near : Start{undeformed(problem.contact(), problem.scene(), op.mu), {}};
      Handle<Vec> u;
      RBVI_CALL(VecDuplicate(op.f, u.put()));
      const double begin = MPI_Wtime();
      solve_linear(ksp.get(), op.f, u.get());
      const double middle = MPI_Wtime();
      body.set(op.a);
      solve_following(body, problem, op, {}, start, options);
      linear.push_back(middle - begin);
      result.push_back(std::max(0.0, MPI_Wtime() - middle - linear.back()));
    }
    if (!timed) linear.clear();
    return result;
  };
  (void)seconds(NonlinearMethod::kacanov, false, false); // asks for the compliance
  std::vector<BenchRow> rows;
  const auto add = [&](const std::string &name, NonlinearMethod method, bool warm) {
    rows.push_back(timed_row("iteration: " + name, "this part alone, the compliance at hand",
                             seconds(method, warm, true)));
  };
  add(from_rest, NonlinearMethod::automatic, false);
  add(from_answer, NonlinearMethod::automatic, true);
  std::vector methods{NonlinearMethod::kacanov, NonlinearMethod::anderson};
  if (has_curvature(problem.contact()) && !has_friction(problem.scene()))
    methods.push_back(NonlinearMethod::newton);
  for (const auto method : methods)
    add(nonlinear_method_names()[static_cast<std::size_t>(method)] + ", " + from_rest, method,
        false);
  rows.push_back(timed_row("one linear solve", "this part alone", linear));
  return rows;
}

BenchRow bench_vi(Problem &lumped, const std::vector<Mu> &set) {
  HfOptions options;
  HighFidelity active_set(lumped, options);
  options.method = HfMethod::vi;
  std::vector<Sample> truths;
  for (const Mu &mu : set) {
    HfSolution truth = active_set.solve(mu);
    truths.push_back({mu, std::move(truth.u), std::move(truth.lambda), truth.outputs});
  }
  return bench_solver(lumped, options, truths, truths.size(), From::cold);
}

BenchRow bench_interpolation(Problem &problem, const std::vector<Sample> &snapshots,
                             const std::vector<Sample> &truths) {
  const std::vector<Mu> training = parameters_of(snapshots), set = parameters_of(truths);
  const SampleInterpolation samples(problem.scene().parameters, training);
  std::vector<Sample> answers;
  const std::vector<double> seconds = seconds_each(set, [&](const Mu &mu) {
    Sample answer{
        mu, Vector::Zero(truths.front().u.size()), Vector::Zero(truths.front().lambda.size()), {}};
    for (const auto &[number, weight] : samples.weights(mu)) {
      answer.u += weight * snapshots[number].u;
      answer.lambda += weight * snapshots[number].lambda;
    }
    answers.push_back(std::move(answer));
  });
  Errors errors(problem);
  for (std::size_t p = 0; p < answers.size(); ++p) {
    errors.add(answers[p].u, answers[p].lambda, truths[p]);
    for (const auto &[number, weight] : samples.weights(set[p]))
      add_outputs(weight, snapshots[number].outputs, answers[p].outputs);
  }
  BenchRow row = timed_row(samples.on_grid() ? "multilinear interpolation"
                                             : "interpolation by cubic radial functions",
                           "field; constraints not enforced", seconds);
  errors.store(row);
  row.outputs_max = largest_output_error(outputs_of(answers), outputs_of(truths));
  for (const Sample &snapshot : snapshots)
    row.offline += snapshot.outputs.seconds.value_or(0);
  return row;
}

} // namespace rbvi
