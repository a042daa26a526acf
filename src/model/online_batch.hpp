// What one answer and a table of them share.
#pragma once

#include "rbvi/model/online.hpp"
#include "rbvi/model/online_tool.hpp"

namespace rbvi {

/// Its `seconds` are those of theta, assembly and solution, the checks and the outputs, and with
/// `full` of the field. Throws as OnlineSolver::solve.
Outputs answer(OnlineSolver &solver, const Mu &mu, const OnlineArguments &arguments,
               ReducedAnswer &solution);

/// The largest violation of the laws of contact and friction at any node, relative.
double violation(const Outputs &outputs);

/// A line where answers on a support break the laws: only a reduced law that is not mended does.
void warn_of_violation(const ReducedModel &model, double violation, std::ostream &out);

/// A line where `answers` of them lie next to a failed training sample (nearest_sample_failed).
void warn_of_failed_samples(long answers, std::ostream &out);

/// A line where `answers` of them lie nearer to the boundary of the box than any parameter at which
/// errors were measured (beyond_validation).
void warn_of_unvalidated(long answers, std::ostream &out);

/// An answer as one JSON object, one line: parameters and outputs with value and unit, outputs
/// where it was measured (`errors`) with expected_error; residual, inside, to_other, warnings. A
/// number that is none is null.
std::string json_of(const OnlineSolver &solver, const Mu &mu, const ReducedAnswer &solution,
                    const Outputs &outputs, const ErrorOfOutput &errors,
                    const std::string &warnings);

/// What answers are along their contacts, as CSV: for each node of each contact the row, the
/// contact, the place and the fields, vectors by component.
class TraceTable {
public:
  /// Its columns are those of the first training parameter whose answer faces something everywhere.
  TraceTable(OnlineSolver &solver, int digits);
  std::string header() const;
  /// Of the answer in this row of the table of answers, from 1. What a contact has not is empty.
  std::string rows(const OnlineSolver &solver, const ReducedAnswer &solution, long row) const;

private:
  std::string format_;
  std::vector<std::string> columns_;
};

/// Answers all queries, row by row, or 64 for each of several threads at a time, in constant
/// memory, into a temporary file, which becomes FILE at the end, or to `out`; traces along contacts
/// likewise. `solvers`: of one model, one for each thread. A set that can be read twice is read to
/// its end before the first answer; the rows of a stream say so themselves where they are none.
/// Throws bad_input for a wrong set, and failure, at the end, where some query has no answer.
void answer_many(const OnlineArguments &arguments, const std::vector<OnlineSolver *> &solvers,
                 std::ostream &out);

} // namespace rbvi
