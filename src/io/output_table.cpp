#include "rbvi/io/output_table.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

namespace rbvi {

std::vector<std::string> csv_fields(const std::string &line, char separator) {
  std::vector<std::string> fields{""};
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
      fields.back() += line[++i];
    else if (c == '"')
      quoted = !quoted;
    else if (c == separator && !quoted)
      fields.emplace_back();
    else
      fields.back() += c;
  }
  if (quoted) throw bad_input("a double quote is not closed");
  return fields;
}

std::string csv_quoted(const std::string &text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"') result += '"';
    result += c == '\n' || c == '\r' ? ' ' : c;
  }
  return result + '"';
}

namespace {

/// As a field of CSV.
std::string csv_field(const std::string &text) {
  return text.find_first_of(",\"\r\n") == std::string::npos ? text : csv_quoted(text);
}

} // namespace

RowText row_of(const Mu &mu, const std::vector<std::string> &passed) {
  RowText row{passed, {}};
  for (const double value : mu)
    row.parameters.push_back(shortest_number(value));
  return row;
}

OutputTable::OutputTable(std::ostream &out, const ParameterSpace &space, const Outputs &like,
                         TableStyle style)
    : out_(out), parameters_(space.size()), columns_(columns_of({like})), style_(std::move(style)) {
  for (const std::string &name : style_.passed)
    out_ << csv_field(name) << ',';
  for (int i = 0; i < parameters_; ++i)
    out_ << (i > 0 ? "," : "") << space.at(i).name;
  for (const OutputColumn &column : columns_) {
    out_ << ',' << csv_field(column.name);
    if (style_.errors.contains(column.name)) out_ << ',' << csv_field(column.name + "_error");
  }
  out_ << (style_.status ? ",status\n" : "\n");
}

void OutputTable::begin(const RowText &row) {
  for (std::size_t i = 0; i < style_.passed.size(); ++i)
    out_ << (i < row.passed.size() ? csv_field(row.passed[i]) : "") << ',';
  for (std::size_t i = 0; i < static_cast<std::size_t>(parameters_); ++i)
    out_ << (i > 0 ? "," : "") << (i < row.parameters.size() ? csv_field(row.parameters[i]) : "");
}

void OutputTable::add(const Mu &mu, const Outputs &outputs, bool errors_hold,
                      const std::vector<std::string> &passed) {
  begin(row_of(mu, passed));
  const std::string format = "%." + std::to_string(style_.digits) + "g";
  for (const OutputColumn &column : columns_) {
    const std::optional<double> value = column.of(outputs);
    out_ << ',' << (value ? formatted(format.c_str(), *value) : "");
    const auto error = style_.errors.find(column.name);
    if (error != style_.errors.end())
      out_ << ',' << (errors_hold ? formatted("%.1e", error->second) : "");
  }
  out_ << (style_.status ? ",ok\n" : "\n");
}

void OutputTable::add_failure(const RowText &row, const std::string &reason) {
  begin(row);
  for (const OutputColumn &column : columns_)
    out_ << (style_.errors.contains(column.name) ? ",," : ",");
  out_ << ',' << csv_quoted(reason) << '\n';
}

void write_csv(std::ostream &out, const ParameterSpace &space, const std::vector<Mu> &mus,
               const std::vector<Outputs> &rows) {
  if (mus.size() != rows.size())
    throw failure("a table of " + std::to_string(mus.size()) + " parameters and " +
                  std::to_string(rows.size()) + " results");
  Outputs like;
  for (const OutputColumn &column : columns_of(rows)) {
    if (column.value == nullptr)
      like.named.push_back({column.name, 0});
    else
      like.*column.value = 0;
  }
  OutputTable table(out, space, like);
  for (std::size_t r = 0; r < rows.size(); ++r)
    table.add(mus[r], rows[r]);
}

} // namespace rbvi
