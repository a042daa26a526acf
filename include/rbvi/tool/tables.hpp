// Tables and small text of the commands.
#pragma once

#include "rbvi/sweep/sweep.hpp"

#include <algorithm>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

namespace rbvi {

/// Columns of equal length under a header, as CSV, every digit: errors are
/// differences of these. Atomically. Throws failure.
void write_columns(const std::filesystem::path &path, const std::vector<std::string> &names,
                   const std::vector<std::vector<double>> &columns);

/// Columns under their names.
struct Table {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;

  /// A parameter that is called like this column becomes mu_NAME, as in pictures.
  template <class Values> void add(const std::string &name, const Values &values) {
    const auto same = std::ranges::find(names, name);
    if (same != names.end()) *same = "mu_" + name;
    names.push_back(name);
    columns.emplace_back(values.begin(), values.end());
  }
  /// One column per free parameter.
  void add(const ParameterSpace &space, const std::vector<Mu> &set);
  /// Throws failure.
  void write(const std::filesystem::path &path) const { write_columns(path, names, columns); }
};

/// One column: a member of every row.
template <class Row, class Value>
std::vector<double> column(const std::vector<Row> &rows, Value Row::*member) {
  std::vector<double> values;
  for (const Row &row : rows)
    values.push_back(static_cast<double>(row.*member));
  return values;
}

/// One row per sample: parameters, outputs.
void write_sample_table(const std::filesystem::path &path, const ParameterSpace &space,
                        const std::vector<Sample> &samples);

/// What the samples of a sweep have in common: a line each where some took load steps, touch an end
/// of the contact boundary, rest on few nodes (ResolutionTally), or lock.
void tell_of_samples(const Scene &scene, const Contact &contact, const std::vector<Sample> &samples,
                     std::ostream &out);

} // namespace rbvi
