#include "rbvi/io/parameter_sets.hpp"

#include "rbvi/core/box.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/outputs.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/io/output_table.hpp"
#include "rbvi/io/system_error.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>

namespace rbvi {

namespace {

using Generator = std::function<std::optional<Mu>()>;

constexpr double largest_set = 1e7;
const std::string id_name = "id";  ///< of a column that is handed on though tables of rbvi have it
const std::string plus = " + ";    ///< between the sets of a sum
const std::string within = " in "; ///< before a part of the box

int parse_count(const std::string &text, const std::string &what) {
  const double value = parse_number(text, what);
  if (value < 1 || value > largest_set || value != std::floor(value))
    throw bad_input(what + " is " + trimmed(text) + ": it must be a positive whole number");
  return static_cast<int>(value);
}

/// The fraction t of the way through the box; fused, so that every machine rounds it alike.
double at_fraction(const Parameter &p, double t) {
  return t >= 1 ? p.upper : std::fma(t, p.upper - p.lower, p.lower);
}

/// "9,9" for two parameters.
std::string example_counts(const ParameterSpace &space) {
  return joined(std::vector<std::string>(space.size(), "9"), ",");
}

Generator grid(const ParameterSpace &space, const std::string &text) {
  const std::vector<std::string> entries = split(text, ',');
  if (static_cast<int>(entries.size()) != space.size())
    throw bad_input("grid:" + text + " has " + counted(std::ssize(entries), "count") + " for " +
                    counted(space.size(), "free parameter") + " (" + names_of(space) +
                    "): give one for each, grid:" + example_counts(space) +
                    ", or a number of random ones, random:60");
  std::vector<int> counts;
  double total = 1;
  for (int i = 0; i < space.size(); ++i) {
    counts.push_back(parse_count(entries[i], "grid count of " + space.at(i).name));
    if (const auto &choices = space.at(i).choices;
        !choices.empty() && counts.back() > std::ssize(choices))
      throw bad_input("grid:" + text + " has " + std::to_string(counts.back()) + " values of " +
                      space.at(i).name + ", which has " + std::to_string(choices.size()));
    total *= counts.back();
  }
  if (total > largest_set)
    throw bad_input("grid:" + text + " has more than " +
                    std::to_string(static_cast<long>(largest_set)) + " points");
  return [space, counts, k = 0L, end = static_cast<long>(total)]() mutable -> std::optional<Mu> {
    if (k == end) return std::nullopt;
    Mu mu(counts.size());
    long rest = k++;
    for (std::size_t i = counts.size(); i-- > 0; rest /= counts[i])
      mu[i] = taken(space.at(static_cast<int>(i)),
                    at_fraction(space.at(static_cast<int>(i)),
                                counts[i] == 1 ? 0.5 : double(rest % counts[i]) / (counts[i] - 1)));
    return mu;
  };
}

/// splitmix64 (Steele, Lea, Flood 2014): a counter, mixed; the standard library's distributions
/// differ between machines.
std::uint64_t next_random(std::uint64_t &state) {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// Choices are as likely as each other.
double random_value(const Parameter &p, double t) {
  if (p.choices.empty()) return at_fraction(p, t);
  return std::min(p.upper, p.lower + std::floor(t * (p.upper - p.lower + 1)));
}

Generator random_set(const ParameterSpace &space, const std::string &text) {
  const std::vector<std::string> entries = split(text, ':');
  if (entries.size() != 2) throw bad_input("'random:" + text + "': write random:COUNT:SEED");
  const int count = parse_count(entries[0], "count of random points");
  const double seed = parse_number(entries[1], "random seed");
  if (seed < 0 || seed > 9e15 || seed != std::floor(seed))
    throw bad_input("random seed " + trimmed(entries[1]) + ": it must be a whole number >= 0");
  return [space, left = count,
          state = static_cast<std::uint64_t>(seed)]() mutable -> std::optional<Mu> {
    if (left-- <= 0) return std::nullopt;
    Mu mu;
    for (int i = 0; i < space.size(); ++i)
      mu.push_back(
          random_value(space.at(i), static_cast<double>(next_random(state) >> 11) * 0x1p-53));
    return mu;
  };
}

/// The space with the range "radius=0.7,1.15", a part of its own.
ParameterSpace narrowed(ParameterSpace space, const std::string &range) {
  const std::size_t equals = range.find('=');
  const std::string name = trimmed(range.substr(0, equals));
  const std::optional<std::size_t> i = find_free(space, name);
  if (!i) throw unknown_parameter(space, name);
  const std::vector<std::string> ends = split(range.substr(std::min(equals, range.size())), ',');
  if (ends.size() != 2) throw bad_input("'in " + range + "': write in " + name + "=LOWER,UPPER");
  Parameter &parameter = space.all[space.free[*i]];
  const double lower = parse_number(ends[0].substr(1), "lower bound of " + name),
               upper = parse_number(ends[1], "upper bound of " + name);
  if (!(parameter.lower <= lower && lower <= upper && upper <= parameter.upper))
    throw bad_input("'in " + range + "' is no part of the range of " + name + ", " +
                    short_number(parameter.lower) + " to " + short_number(parameter.upper));
  parameter.lower = lower;
  parameter.upper = upper;
  return space;
}

/// A CSV table on a stream.
class CsvRows {
public:
  /// `row`: where the text of each row goes.
  CsvRows(const ParameterSpace &space, std::string name, std::istream &in, bool allow_outside,
          const std::vector<OutputForm> &own, RowText &row)
      : space_(space), name_(std::move(name)), in_(in), allow_outside_(allow_outside), own_(own),
        row_(row) {
    std::string line;
    if (!next_line(line)) throw no_rows();
    while_doing(reading(), [&] { read_header(line); });
  }
  const std::vector<std::string> &passed() const { return passed_; }
  std::optional<Mu> next() {
    std::string line;
    if (!next_line(line)) {
      if (rows_ == 0) throw no_rows();
      return std::nullopt;
    }
    ++rows_;
    return while_doing(reading(), [&] {
      Mu mu = read_row(line);
      check_mu(space_, mu, allow_outside_);
      return mu;
    });
  }

private:
  std::string reading() const { return "reading line " + std::to_string(line_) + " of " + name_; }
  Error no_rows() const {
    return bad_input(name_ + " has no rows under a header of " + names_of(space_));
  }
  /// The next line that is not blank.
  bool next_line(std::string &line) {
    while (std::getline(in_, line)) {
      if (++line_ == 1 && line.starts_with("\xef\xbb\xbf")) line.erase(0, 3); // byte order mark
      if (!trimmed(line).empty()) return true;
    }
    if (in_.bad()) throw failure("cannot read " + name_ + " behind line " + std::to_string(line_));
    return false;
  }
  void read_header(const std::string &line) {
    std::vector<bool> found(space_.size(), false);
    if (line.find(';') != std::string::npos && csv_fields(line).size() == 1) separator_ = ';';
    for (const std::string &field : csv_fields(line, separator_)) {
      const std::string name = trimmed(field);
      const std::optional<std::size_t> i = find_free(space_, name);
      if (!i && (name == id_name || !is_passed_over(name))) {
        if (std::ranges::find(space_.all, name, &Parameter::name) != space_.all.end())
          throw unknown_parameter(space_, name);
        passed_.push_back(name);
        passed_at_.push_back(columns_.size());
      }
      if (i && found[*i]) throw bad_input("two columns are named '" + name + "'");
      if (i) found[*i] = true;
      columns_.push_back(i);
    }
    const bool all = std::find(found.begin(), found.end(), false) == found.end();
    const auto other =
        std::ranges::find_if(passed_, [](const std::string &name) { return name != id_name; });
    if (!all && other != passed_.end()) throw unknown_parameter(space_, *other);
    if (!all) throw bad_input("the header must name every free parameter: " + names_of(space_));
  }
  bool is_passed_over(const std::string &name) const {
    return is_table_column(name) || std::ranges::any_of(own_, [&](const OutputForm &form) {
             return name == form.name || name == form.name + "_error";
           });
  }
  Mu read_row(const std::string &line) {
    row_ = {{}, std::vector<std::string>(space_.size())};
    std::vector<std::string> entries = csv_fields(line, separator_);
    for (std::size_t k = 0; k < std::min(entries.size(), columns_.size()); ++k)
      if (columns_[k]) row_.parameters[*columns_[k]] = trimmed(entries[k]);
    for (const std::size_t k : passed_at_)
      row_.passed.push_back(k < entries.size() ? entries[k] : "");
    if (entries.size() != columns_.size())
      throw bad_input(std::to_string(entries.size()) + " entries under " +
                      std::to_string(columns_.size()) + " columns");
    Mu mu(space_.size());
    for (std::size_t k = 0; k < columns_.size(); ++k)
      if (separator_ == ';' && columns_[k]) std::ranges::replace(entries[k], ',', '.');
    for (std::size_t k = 0; k < columns_.size(); ++k)
      if (columns_[k])
        mu[*columns_[k]] =
            parse_value(space_.at(static_cast<int>(*columns_[k])), entries[k],
                        "parameter " + space_.at(static_cast<int>(*columns_[k])).name);
    return mu;
  }

  const ParameterSpace &space_;
  std::string name_;
  std::istream &in_;
  bool allow_outside_;
  std::vector<OutputForm> own_;
  RowText &row_;
  std::vector<std::optional<std::size_t>> columns_; ///< free parameter of each column, if any
  std::vector<std::string> passed_;                 ///< columns that are handed on
  std::vector<std::size_t> passed_at_;
  char separator_ = ',';
  long line_ = 0, rows_ = 0;
};

/// An open file; null for standard input. Throws bad_input for one that cannot be read.
std::shared_ptr<std::ifstream> opened(const ParameterSpace &space, const std::string &name) {
  if (name == "-") return nullptr;
  errno = 0;
  auto file = std::make_shared<std::ifstream>(name);
  const bool empty = *file && file->peek() == EOF && !file->bad();
  if (!*file && !empty)
    throw bad_input("cannot read '" + name + "' (a set is grid:5,5, random:200:1 or a CSV file)" +
                    system_reason());
  if (empty) throw bad_input(name + " has no rows under a header of " + names_of(space));
  return file;
}

} // namespace

ParameterReader::ParameterReader(const ParameterSpace &space, const std::string &text,
                                 bool allow_outside, const std::vector<OutputForm> &own) {
  const std::size_t part = is_set_file(text) ? std::string::npos : text.find(within);
  if (part != std::string::npos) {
    next_ = ParameterReader(narrowed(space, text.substr(part + within.size())),
                            trimmed(text.substr(0, part)))
                .next_;
  } else if (text.starts_with("grid:")) {
    next_ = grid(space, text.substr(5));
  } else if (text.starts_with("random:")) {
    next_ = random_set(space, text.substr(7));
  } else if (text == "corners") {
    next_ = [set = corners_and_faces(space), k = std::size_t{0}]() mutable {
      return k < set.size() ? std::optional<Mu>(set[k++]) : std::nullopt;
    };
  } else if (!text.empty() && text.find_first_not_of("0123456789") == std::string::npos) {
    next_ = random_set(space, text + ":1");
  } else {
    const std::shared_ptr<std::ifstream> file = opened(space, text);
    const auto rows = std::make_shared<CsvRows>(space, file ? text : "standard input",
                                                file ? *file : std::cin, allow_outside, own, *row_);
    passed_ = rows->passed();
    next_ = [file, rows, row = row_] { return rows->next(); };
  }
}

std::vector<Mu> parse_set(const ParameterSpace &space, const std::string &text, bool allow_outside,
                          const std::vector<OutputForm> &own) {
  std::vector<Mu> set;
  for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + plus.size()) {
    end = text.find(plus, begin);
    const std::string part = trimmed(text.substr(begin, end - begin));
    if (part == "-") throw bad_input("a set cannot come from standard input here: name a CSV file");
    if (part != trimmed(text) && is_set_file(part))
      throw bad_input("'" + part + "' in '" + text +
                      "': a sum is of grids, random points and "
                      "corners; put them into the file");
    ParameterReader reader(space, part, allow_outside, own);
    for (const std::string &name : reader.passed())
      if (name != id_name) throw unknown_parameter(space, name);
    while (std::optional<Mu> mu = reader.next())
      set.push_back(std::move(*mu));
  }
  return set;
}

bool is_set_file(const std::string &set) {
  return !set.empty() && !set.starts_with("grid:") && !set.starts_with("random:") &&
         set != "corners" && set.find(plus) == std::string::npos &&
         set.find_first_not_of("0123456789") != std::string::npos;
}

bool is_stream(const std::string &set) {
  std::error_code error;
  const auto status = std::filesystem::status(set, error);
  return set == "-" ||
         (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
          !std::filesystem::is_directory(status));
}

} // namespace rbvi
