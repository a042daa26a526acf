// Sets of parameter values: training, validation, queries.
#pragma once

#include "rbvi/core/parameters.hpp"
#include "rbvi/io/parameter_sets.hpp"

#include <functional>
#include <optional>

namespace rbvi {

/// Reads "grid:5,5,5" (box ends included, last parameter fastest; a count of 1 is the middle),
/// "random:200:seed" or "200" for seed 1 (uniform, the same on every machine), or the name of a CSV
/// file with a header of parameter names, in any order; columns that a table of rbvi has beside
/// them (is_table_column) are passed over. Every mu is checked. Throws bad_input, naming the line.
std::vector<Mu> parse_set(const ParameterSpace &space, const std::string &text,
                          bool allow_outside = false);

/// A set one by one, in constant memory; "-" is a CSV table on standard input.
class ParameterReader {
public:
  /// `space` must outlive it. Throws bad_input for a set that cannot be read from the beginning.
  ParameterReader(const ParameterSpace &space, const std::string &text, bool allow_outside = false);
  /// The next one, nothing at the end. Throws bad_input, naming the line, for a row that is none;
  /// the rows behind it can still be read.
  std::optional<Mu> next() { return next_(); }

private:
  std::function<std::optional<Mu>()> next_;
};

/// Whether the set can be read only once: standard input, a pipe.
bool is_stream(const std::string &set);

} // namespace rbvi
