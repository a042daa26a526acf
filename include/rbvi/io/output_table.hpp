// The table of answers as CSV.
#pragma once

#include "rbvi/core/outputs.hpp"
#include "rbvi/io/output_table.hpp"

namespace rbvi {

/// A table of answers, row by row: the free parameters with all digits that it takes to read them
/// back, the outputs with 10 digits, beside each the error that was measured for it, and on request
/// a last column `status`: "ok", or why there is no answer.
class OutputTable {
public:
  /// Writes the header. Columns are those that `like` has. `out` must outlive it.
  OutputTable(std::ostream &out, const ParameterSpace &space, const Outputs &like,
              ErrorOfOutput errors = {}, bool status = false);
  /// An output that is not set leaves its place empty, as do errors where they do not hold.
  void add(const Mu &mu, const Outputs &outputs, bool errors_hold = true);
  /// A row without an answer; `mu` empty where there is none. Needs the column `status`.
  void add_failure(const Mu &mu, const std::string &reason);

private:
  void begin(const Mu &mu);
  std::ostream &out_;
  int parameters_;
  std::vector<OutputColumn> columns_;
  ErrorOfOutput errors_;
  bool status_;
};

/// A whole table without errors and status. A column that is set in any row is there.
void write_csv(std::ostream &out, const ParameterSpace &space, const std::vector<Mu> &mus,
               const std::vector<Outputs> &rows);

} // namespace rbvi
