#include "rbvi/io/output_table.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/io/csv.hpp"

namespace rbvi {

OutputTable::OutputTable(std::ostream &out, const ParameterSpace &space, const Outputs &like,
                         ErrorOfOutput errors, bool status)
    : out_(out), parameters_(space.size()), errors_(std::move(errors)), status_(status) {
  for (const OutputColumn &column : output_columns())
    if (like.*column.value) columns_.push_back(column);
  for (int i = 0; i < parameters_; ++i)
    out_ << (i > 0 ? "," : "") << space.at(i).name;
  for (const OutputColumn &column : columns_) {
    out_ << ',' << column.name;
    if (errors_.contains(column.name)) out_ << ',' << column.name << "_error";
  }
  out_ << (status_ ? ",status\n" : "\n");
}

void OutputTable::begin(const Mu &mu) {
  for (int i = 0; i < parameters_; ++i)
    out_ << (i > 0 ? "," : "")
         << (mu.empty() ? "" : shortest_number(mu[static_cast<std::size_t>(i)]));
}

void OutputTable::add(const Mu &mu, const Outputs &outputs, bool errors_hold) {
  begin(mu);
  for (const OutputColumn &column : columns_) {
    const std::optional<double> value = outputs.*column.value;
    out_ << ',' << (value ? formatted("%.10g", *value) : "");
    const auto error = errors_.find(column.name);
    if (error != errors_.end())
      out_ << ',' << (errors_hold ? formatted("%.1e", error->second) : "");
  }
  out_ << (status_ ? ",ok\n" : "\n");
}

void OutputTable::add_failure(const Mu &mu, const std::string &reason) {
  begin(mu);
  for (const OutputColumn &column : columns_)
    out_ << (errors_.contains(column.name) ? ",," : ",");
  out_ << ',' << csv_quoted(reason) << '\n';
}

void write_csv(std::ostream &out, const ParameterSpace &space, const std::vector<Mu> &mus,
               const std::vector<Outputs> &rows) {
  if (mus.size() != rows.size())
    throw failure("a table of " + std::to_string(mus.size()) + " parameters and " +
                  std::to_string(rows.size()) + " results");
  Outputs like;
  for (const OutputColumn &column : output_columns())
    for (const Outputs &row : rows)
      if (row.*column.value) like.*column.value = row.*column.value;
  OutputTable table(out, space, like);
  for (std::size_t r = 0; r < rows.size(); ++r)
    table.add(mus[r], rows[r]);
}

} // namespace rbvi
