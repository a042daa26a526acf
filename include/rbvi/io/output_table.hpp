// The table of answers as CSV.
#pragma once

#include "rbvi/core/outputs.hpp"

#include <string>
#include <vector>

namespace rbvi {

/// A row of a table as its text stands there.
struct RowText {
  std::vector<std::string> passed;     ///< of the columns that are handed on
  std::vector<std::string> parameters; ///< of the free ones
};

/// Those of an answer; the shortest that read back as the same numbers.
RowText row_of(const Mu &mu, const std::vector<std::string> &passed = {});

/// What a table of answers has beside parameters and outputs.
struct TableStyle {
  ErrorOfOutput errors = {};            ///< beside each of these outputs
  bool status = false;                  ///< a last column `status`: "ok", or why there is no answer
  int digits = 10;                      ///< of the outputs
  std::vector<std::string> passed = {}; ///< first columns, handed on from the queries
};

/// A table of answers, row by row: the free parameters with all digits that it takes to read them
/// back, the outputs with a given number of them.
class OutputTable {
public:
  /// Writes the header. Columns are those that `like` has. `out` must outlive it.
  OutputTable(std::ostream &out, const ParameterSpace &space, const Outputs &like,
              TableStyle style = {});
  /// An output that is not set leaves its place empty, as do errors where they do not hold.
  void add(const Mu &mu, const Outputs &outputs, bool errors_hold = true,
           const std::vector<std::string> &passed = {});
  /// A row without an answer: what is known of it stays. Needs the column `status`.
  void add_failure(const RowText &row, const std::string &reason);

private:
  void begin(const RowText &row);
  std::ostream &out_;
  int parameters_;
  std::vector<OutputColumn> columns_;
  TableStyle style_;
};

/// A whole table without errors and status. A column that is set in any row is there.
void write_csv(std::ostream &out, const ParameterSpace &space, const std::vector<Mu> &mus,
               const std::vector<Outputs> &rows);

/// The fields of a row; those in double quotes may hold separators, and quotes that are doubled.
/// Throws bad_input for a quote that is not closed.
std::vector<std::string> csv_fields(const std::string &line, char separator = ',');

/// In double quotes, which are doubled inside, without line breaks: one field of a row.
std::string csv_quoted(const std::string &text);

} // namespace rbvi
