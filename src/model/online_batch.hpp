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

/// Answers all queries, row by row, in constant memory, into a temporary file, which becomes FILE
/// at the end, or to `out`. A set that can be read twice is read to its end before the first
/// answer; the rows of a stream say so themselves where they are none. Throws bad_input for a wrong
/// set, and failure, at the end, where some query has no answer.
void answer_many(const OnlineArguments &arguments, OnlineSolver &solver, std::ostream &out);

} // namespace rbvi
