#include "online_batch.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/core/locking.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/core/warnings.hpp"
#include "rbvi/io/output_table.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/io/system_error.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "rbvi/model/print.hpp"
#include "rbvi/model/rows.hpp"
#include "rbvi/model/training_samples.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>

namespace rbvi {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// A temporary file beside FILE until everything is in it, so that of several writers each has its
/// own; a device, or a stream that is there, as it is.
class TableFile {
public:
  TableFile(const std::string &name, std::ostream &standard)
      : name_(name), written_(name), stream_(name.empty() ? standard : file_) {
    if (name.empty()) return;
    const fs::path path = name;
    const fs::file_status status = fs::status(path);
    if (!fs::exists(status) || !fs::is_other(status)) {
      remove_stale_temporaries(path.has_parent_path() ? path.parent_path() : ".",
                               path.filename().string());
      whole_ = std::make_unique<AtomicFile>(path);
      written_ = whole_->temporary().string();
    }
    file_.open(written_);
    check();
  }
  ~TableFile() {
    if (whole_) whole_->leave();
  }
  TableFile(const TableFile &) = delete;
  TableFile &operator=(const TableFile &) = delete;
  std::ostream &stream() { return stream_; }
  /// After every row, which stays whatever happens to the next.
  void check() {
    if (stream_.flush()) return;
    const Error error = cannot_write(name_.empty() ? "to standard output" : name_);
    throw whole_ ? failure(error.what() + ("; the rows are in " + written_)) : error;
  }
  void finish() {
    if (name_.empty()) return;
    file_.close();
    check();
    if (whole_) whole_->commit();
  }

private:
  std::string name_, written_;
  std::unique_ptr<AtomicFile> whole_;
  std::ofstream file_;
  std::ostream &stream_;
};

/// What is said at the end.
struct Tally {
  std::vector<MaterialPoint> contact_points; ///< where locking is looked for
  long rows = 0, unanswered = 0, near_failed = 0, not_alone = 0, unvalidated = 0;
  double seconds = 0, residual = 0, violation = 0, locking = 0;
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
long count_queries(const OnlineArguments &arguments, const Scene &scene) {
  if (is_stream(arguments.queries)) return 0;
  ParameterReader reader(scene.parameters, arguments.queries, arguments.extrapolate, scene.outputs);
  long count = 0;
  while (reader.next())
    ++count;
  return count;
}

/// A query of a table, and what comes of it.
struct Row {
  RowText text;
  std::optional<Mu> mu; ///< nothing: it is none, as `failed` says
  std::string failed;   ///< why there is no answer; "": there is one
  Outputs outputs{};
  double to_other = 0;
  std::string trace{};
};

/// Up to `most` of the next queries; a row of a stream that is none becomes a row of the table.
std::vector<Row> next_rows(ParameterReader &reader, std::size_t most) {
  std::vector<Row> rows;
  while (rows.size() < most) {
    try {
      const std::optional<Mu> mu = reader.next();
      if (!mu) break;
      rows.push_back({row_of(*mu, reader.row().passed), mu, ""});
    } catch (const Error &error) {
      if (error.status() != Status::bad_input) throw;
      rows.push_back({reader.row(), {}, error.what()});
    }
  }
  return rows;
}

/// The answer, or why there is none. `number`: of the row, from 1.
void answer_row(OnlineSolver &solver, const OnlineArguments &arguments,
                const std::optional<TraceTable> &traces, long number, Row &row) {
  if (!row.mu) return;
  try {
    ReducedAnswer solution;
    row.outputs = answer(solver, *row.mu, arguments, solution);
    row.to_other = solution.to_other;
    if (traces) row.trace = traces->rows(solver, solution, number);
  } catch (const std::exception &error) {
    row.failed = error.what();
  }
}

/// Into the table and the tally.
void add_row(const Row &row, const OnlineSolver &solver, OutputTable &table, Tally &tally) {
  if (!row.failed.empty()) {
    tally.add_failure(row.failed);
    table.add_failure(row.text, row.failed);
    return;
  }
  const Mu &mu = *row.mu;
  const Scene &scene = solver.scene();
  const bool inside = in_box(scene.parameters, mu);
  table.add(mu, row.outputs, inside, row.text.passed);
  ++tally.rows;
  if (nearest_sample_failed(solver.model(), mu)) ++tally.near_failed;
  if (inside && beyond_validation(solver.model(), mu)) ++tally.unvalidated;
  if (row.to_other > 0) ++tally.not_alone;
  tally.seconds += row.outputs.seconds.value_or(0);
  tally.residual = larger(tally.residual, row.outputs.kkt_residual.value_or(0));
  tally.violation = larger(tally.violation, violation(row.outputs));
  tally.resolution.add(row.outputs);
  tally.locking = std::max(
      tally.locking, locking_ratio(scene, expand(scene.parameters, mu), tally.contact_points));
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
  std::vector<fs::path> written{arguments.out};
  if (!arguments.contact.empty()) written.emplace_back(arguments.contact);
  print_written(out, written);
}

} // namespace

double violation(const Outputs &outputs) {
  const double peak = outputs.peak_pressure.value_or(0);
  const double friction = peak > 0 ? outputs.friction_violation.value_or(0) / peak : 0;
  return larger(outputs.kkt_residual.value_or(0), friction);
}

void warn_of_violation(const ReducedModel &model, double violation, std::ostream &out) {
  constexpr double tolerated = 1e-6;
  if (!model.contact.law || violation <= tolerated) return;
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

namespace {

/// What is to be said of all rows. Throws failure where one has no answer.
void conclude(const ReducedModel &model, const Scene &scene, const Tally &tally, bool tells_errors,
              std::ostream &warnings) {
  warn_of_violation(model, tally.violation, warnings);
  warn_of_balance(warnings, model);
  warn_of_failed_samples(tally.near_failed, warnings);
  warn_of_unvalidated(tally.unvalidated, warnings);
  if (tells_errors && expected_errors(model).count == 0) print_expected_errors(warnings, model);
  tally.resolution.print(warnings);
  warn_of_elements(scene, tally.locking, warnings);
  warn_of_other_answers(warnings, tally.not_alone, tally.rows - tally.unanswered);
  if (tally.unanswered > 0)
    throw failure(
        std::to_string(tally.unanswered) + " of " + std::to_string(tally.rows) +
        " queries have no answer: the column status says why (the first: " + tally.reason + ")");
}

} // namespace

void answer_many(const OnlineArguments &arguments, const std::vector<OnlineSolver *> &solvers,
                 std::ostream &out) {
  OnlineSolver &solver = *solvers.front();
  const Scene &scene = solver.scene();
  const long total = count_queries(arguments, scene);
  ParameterReader reader(scene.parameters, arguments.queries, arguments.extrapolate, scene.outputs);
  const bool to_file = !arguments.out.empty() && arguments.out != "-";
  Tally tally;
  tally.contact_points = material_points(solver.contact());
  const Outputs like = example_outputs(solver.model(), [&](const Mu &mu) {
    ReducedAnswer unused;
    return asked_of(answer(solver, mu, arguments, unused), arguments.asked());
  });
  TableFile file(to_file ? arguments.out : "", out);
  std::optional<TableFile> trace_file;
  std::optional<TraceTable> traces;
  if (!arguments.contact.empty())
    trace_file.emplace(arguments.contact, out).stream()
        << traces.emplace(solver, arguments.digits()).header();
  {
    QueryProgress progress(total);
    OutputTable table(
        file.stream(), scene.parameters, like,
        {errors_of_outputs(solver.model()), true, arguments.digits(), reader.passed()});
    const auto threads = static_cast<unsigned>(solvers.size());
    const std::size_t most = threads == 1 ? 1 : rows_of_thread * threads;
    for (auto rows = next_rows(reader, most); !rows.empty(); rows = next_rows(reader, most)) {
      over_rows(rows.size(), threads, [&](unsigned thread, std::size_t i) {
        answer_row(*solvers[thread], arguments, traces, tally.rows + 1 + static_cast<long>(i),
                   rows[i]);
      });
      for (const Row &row : rows) {
        add_row(row, solver, table, tally);
        if (trace_file) trace_file->stream() << row.trace;
      }
      file.check();
      progress.update(tally);
    }
    file.check();
  }
  file.finish();
  if (trace_file) trace_file->finish();
  if (to_file) report(arguments, solver, tally, out);
  conclude(solver.model(), scene, tally, !to_file, to_file ? out : std::cerr);
}

} // namespace rbvi
