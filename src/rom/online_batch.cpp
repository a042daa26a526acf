#include "online_batch.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/io/output_table.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/rom/model/training_samples.hpp"
#include "rbvi/rom/print.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>

namespace rbvi {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// FILE.partial until everything is in it; a device, or a stream that is there, as it is.
class TableFile {
public:
  TableFile(const std::string &name, std::ostream &standard)
      : name_(name), written_(name), stream_(name.empty() ? standard : file_) {
    if (name.empty()) return;
    const fs::file_status status = fs::status(name);
    if (fs::is_directory(status)) throw failure("cannot write " + name + ": it is a directory");
    if (!fs::exists(status) || fs::is_regular_file(status)) written_ += ".partial";
    file_.open(written_);
    check();
  }
  std::ostream &stream() { return stream_; }
  /// After every row, which stays whatever happens to the next.
  void check() {
    if (!stream_.flush())
      throw failure("cannot write " + (name_.empty() ? "to standard output" : written_));
  }
  void finish() {
    if (name_.empty()) return;
    file_.close();
    std::error_code error;
    if (file_ && written_ != name_) fs::rename(written_, name_, error);
    if (!file_ || error) throw failure("cannot write " + name_ + ": the rows are in " + written_);
  }

private:
  std::string name_, written_;
  std::ofstream file_;
  std::ostream &stream_;
};

/// What is said at the end.
struct Tally {
  long rows = 0, unanswered = 0, near_failed = 0, unvalidated = 0;
  double seconds = 0, residual = 0, violation = 0;
  std::string reason; ///< of the first row without an answer
  ResolutionTally resolution;
  void add_failure(const std::string &why) {
    ++rows;
    if (unanswered++ == 0) reason = why;
  }
};

/// On standard error now and then: one updating line on a terminal, else a line every ten seconds.
class QueryProgress {
public:
  /// `total`: 0 where nobody knows.
  explicit QueryProgress(long total) : total_(total), terminal_(isatty(STDERR_FILENO) == 1) {}
  ~QueryProgress() {
    if (terminal_ && shown_) std::cerr << '\n';
  }
  void update(const Tally &tally) {
    const double since = std::chrono::duration<double>(Clock::now() - last_).count();
    if (since < (terminal_ ? 0.5 : 10)) return;
    last_ = Clock::now();
    shown_ = true;
    const double elapsed = std::chrono::duration<double>(last_ - start_).count();
    std::cerr << (terminal_ ? "\r  " : "  ") << tally.rows;
    if (total_ > 0) std::cerr << " of " << total_;
    std::cerr << " queries, " << tally.unanswered << " without an answer";
    if (total_ > 0)
      std::cerr << ", "
                << short_number(elapsed / static_cast<double>(tally.rows) *
                                static_cast<double>(total_ - tally.rows))
                << " s left";
    std::cerr << (terminal_ ? "\x1b[K" : "\n") << std::flush;
  }

private:
  long total_;
  bool terminal_, shown_ = false;
  Clock::time_point start_ = Clock::now(), last_ = start_;
};

/// The number of queries, each of which is read and checked; 0 for a stream.
long count_queries(const OnlineArguments &arguments, const ParameterSpace &space) {
  if (is_stream(arguments.queries)) return 0;
  ParameterReader reader(space, arguments.queries, arguments.extrapolate);
  long count = 0;
  while (reader.next())
    ++count;
  return count;
}

/// Which outputs this model has: those of the first of its training parameters, or of some random
/// ones, that it answers.
Outputs example(OnlineSolver &solver, const OnlineArguments &arguments) {
  const Matrix &trained = solver.model().trained_mu;
  std::vector<Mu> candidates = parse_set(solver.scene().parameters, "random:100:1");
  for (Index p = trained.cols(); p-- > 0;)
    candidates.insert(candidates.begin(), Mu(trained.col(p).begin(), trained.col(p).end()));
  ReducedSolution solution;
  for (const Mu &mu : candidates) {
    try {
      return answer(solver, mu, arguments, solution);
    } catch (const Error &) {
      continue;
    }
  }
  return {};
}

/// The next query; a row of a stream that is none becomes a row of the table. Nothing at the end.
std::optional<Mu> next_query(ParameterReader &reader, OutputTable &table, Tally &tally) {
  for (;;) {
    try {
      return reader.next();
    } catch (const Error &error) {
      if (error.status() != Status::bad_input) throw;
      tally.add_failure(error.what());
      table.add_failure({}, error.what());
    }
  }
}

/// One row: the answer, or why there is none.
void answer_row(const Mu &mu, OnlineSolver &solver, const OnlineArguments &arguments,
                OutputTable &table, Tally &tally) {
  try {
    ReducedSolution solution;
    const Outputs outputs = answer(solver, mu, arguments, solution);
    const bool inside = in_box(solver.scene().parameters, mu);
    table.add(mu, outputs, inside);
    ++tally.rows;
    if (nearest_sample_failed(solver.model(), mu)) ++tally.near_failed;
    if (inside && beyond_validation(solver.model(), mu)) ++tally.unvalidated;
    tally.seconds += outputs.seconds.value_or(0);
    tally.residual = std::max(tally.residual, outputs.kkt_residual.value_or(0));
    tally.violation = std::max(tally.violation, violation(outputs));
    tally.resolution.add(outputs);
  } catch (const Error &error) {
    tally.add_failure(error.what());
    table.add_failure(mu, error.what());
  }
}

void report(const OnlineArguments &arguments, const OnlineSolver &solver, const Tally &tally,
            std::ostream &out) {
  const long answered = tally.rows - tally.unanswered;
  out << answered << (answered == 1 ? " answer" : " answers");
  if (answered > 0)
    out << ", " << 1e3 * tally.seconds / static_cast<double>(answered)
        << " ms each, largest kkt_residual " << tally.residual;
  out << '\n';
  print_expected_errors(out, solver.model());
  print_written(out, {arguments.out});
}

} // namespace

double violation(const Outputs &outputs) {
  const double peak = outputs.peak_pressure.value_or(0);
  const double friction = peak > 0 ? outputs.friction_violation.value_or(0) / peak : 0;
  return std::max(outputs.kkt_residual.value_or(0), friction);
}

void warn_of_violation(const ReducedModel &model, double violation, std::ostream &out) {
  constexpr double tolerated = 1e-6;
  if (!model.law || violation <= tolerated) return;
  out << "warning: the laws of contact and friction are violated by " << violation
      << " of the largest pressure at some node: reduce again with -multiplier_exact yes, which "
         "mends such answers\n";
}

void warn_of_failed_samples(long answers, std::ostream &out) {
  if (answers == 0) return;
  out << "warning: " << answers << (answers == 1 ? " answer lies" : " answers lie")
      << " nearest to a training parameter that has no high-fidelity answer: nothing there was "
         "checked\n";
}

void warn_of_unvalidated(long answers, std::ostream &out) {
  if (answers == 0) return;
  out << "warning: " << answers << (answers == 1 ? " answer lies" : " answers lie")
      << " nearer to a corner or a face of the box than any parameter at which errors were "
         "measured: theirs may be larger\n";
}

void answer_many(const OnlineArguments &arguments, OnlineSolver &solver, std::ostream &out) {
  const ParameterSpace &space = solver.scene().parameters;
  const long total = count_queries(arguments, space);
  ParameterReader reader(space, arguments.queries, arguments.extrapolate);
  const bool to_file = !arguments.out.empty() && arguments.out != "-";
  Tally tally;
  const Outputs like = example(solver, arguments);
  TableFile file(to_file ? arguments.out : "", out);
  {
    QueryProgress progress(total);
    OutputTable table(file.stream(), space, like, errors_of_outputs(solver.model()), true);
    while (const std::optional<Mu> mu = next_query(reader, table, tally)) {
      answer_row(*mu, solver, arguments, table, tally);
      file.check();
      progress.update(tally);
    }
    file.check();
  }
  file.finish();
  if (to_file) report(arguments, solver, tally, out);
  std::ostream &warnings = to_file ? out : std::cerr;
  warn_of_violation(solver.model(), tally.violation, warnings);
  warn_of_failed_samples(tally.near_failed, warnings);
  warn_of_unvalidated(tally.unvalidated, warnings);
  if (!to_file && expected_errors(solver.model()).count == 0)
    print_expected_errors(warnings, solver.model());
  tally.resolution.print(warnings);
  if (tally.unanswered > 0)
    throw failure(
        std::to_string(tally.unanswered) + " of " + std::to_string(tally.rows) +
        " queries have no answer: the column status says why (the first: " + tally.reason + ")");
}

} // namespace rbvi
