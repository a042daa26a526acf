// Sets of parameter values: training, validation, queries.
#pragma once

#include "rbvi/core/parameters.hpp"
#include "rbvi/core/scene.hpp"
#include "rbvi/io/output_table.hpp"

#include <functional>
#include <memory>
#include <optional>

namespace rbvi {

/// Reads "grid:5,5,5" (box ends included, last parameter fastest; a count of 1 is the middle),
/// "random:200:seed" or "200" for seed 1 (uniform, the same on every machine), "corners"
/// (corners_and_faces), several of these with " + " between them, grid and random also in a part of
/// the box, "grid:61 in radius=0.7,1.15", or the name of a CSV file with a header of parameter
/// names, in any order; columns that a table of rbvi has beside them (is_table_column, and `own`
/// outputs of the scene) are passed over. Every mu is checked. Throws bad_input, naming the line.
std::vector<Mu> parse_set(const ParameterSpace &space, const std::string &text,
                          bool allow_outside = false, const std::vector<OutputForm> &own = {});

/// A set one by one, in constant memory; "-" is a CSV table on standard input. Columns of a table
/// that are neither parameters nor outputs are handed on. Where its header has semicolons and no
/// comma these stand between columns, and numbers may have decimal commas.
class ParameterReader {
public:
  /// `space` must outlive it. Throws bad_input for a set that cannot be read from the beginning.
  ParameterReader(const ParameterSpace &space, const std::string &text, bool allow_outside = false,
                  const std::vector<OutputForm> &own = {});
  /// The next one, nothing at the end. Throws bad_input, naming the line, for a row that is none;
  /// the rows behind it can still be read.
  std::optional<Mu> next() { return next_(); }
  /// Names of the columns that are handed on.
  const std::vector<std::string> &passed() const { return passed_; }
  /// What stands in the row of the last next() of a table; empty for other sets.
  const RowText &row() const { return *row_; }

private:
  std::function<std::optional<Mu>()> next_;
  std::shared_ptr<RowText> row_ = std::make_shared<RowText>();
  std::vector<std::string> passed_;
};

/// Whether the set is the name of a file.
bool is_set_file(const std::string &set);
/// Whether the set can be read only once: standard input, a pipe.
bool is_stream(const std::string &set);

} // namespace rbvi
