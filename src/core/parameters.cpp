#include "rbvi/core/parameters.hpp"

#include "rbvi/core/error.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <optional>
#include <sstream>

namespace rbvi {

namespace {

constexpr std::size_t largest_set = 10'000'000;

std::string trimmed(const std::string &text) {
  const std::string blanks = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

std::string shortest(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string names_of(const ParameterSpace &space) {
  std::string names;
  for (int i = 0; i < space.size(); ++i)
    names += (i > 0 ? "," : "") + space.at(i).name;
  return names;
}

/// Position among the free parameters.
std::optional<std::size_t> find_free(const ParameterSpace &space, const std::string &name) {
  for (int i = 0; i < space.size(); ++i)
    if (space.at(i).name == name) return static_cast<std::size_t>(i);
  return std::nullopt;
}

std::optional<std::size_t> find_any(const ParameterSpace &space, const std::string &name) {
  const auto found = std::find_if(space.all.begin(), space.all.end(),
                                  [&](const Parameter &p) { return p.name == name; });
  if (found == space.all.end()) return std::nullopt;
  return static_cast<std::size_t>(found - space.all.begin());
}

Error unknown_parameter(const ParameterSpace &space, const std::string &name) {
  if (find_any(space, name))
    return bad_input("parameter '" + name + "' is fixed; the free ones are " + names_of(space));
  return bad_input("there is no parameter '" + name + "'; the free ones are " + names_of(space));
}

Mu parse_named(const ParameterSpace &space, const std::vector<std::string> &entries) {
  Mu mu;
  for (int i = 0; i < space.size(); ++i)
    mu.push_back(space.at(i).value);
  std::vector<bool> given(mu.size(), false);
  for (const std::string &entry : entries) {
    const std::size_t equals = entry.find('=');
    if (equals == std::string::npos)
      throw bad_input("'" + entry + "' has no name: give all parameters by name or none");
    const std::string name = trimmed(entry.substr(0, equals));
    const auto i = find_free(space, name);
    if (!i) throw unknown_parameter(space, name);
    if (given[*i]) throw bad_input("parameter '" + name + "' is given twice");
    given[*i] = true;
    mu[*i] = parse_number(entry.substr(equals + 1), "parameter " + name);
  }
  return mu;
}

int parse_count(const std::string &text, const std::string &what) {
  const double value = parse_number(text, what);
  if (value < 1 || value > static_cast<double>(largest_set) || value != std::floor(value))
    throw bad_input(what + " is " + trimmed(text) + ": it must be a positive whole number");
  return static_cast<int>(value);
}

/// The fraction t of the way through the box; fused, so that every machine rounds it alike.
double at_fraction(const Parameter &p, double t) {
  return t >= 1 ? p.upper : std::fma(t, p.upper - p.lower, p.lower);
}

std::vector<Mu> grid(const ParameterSpace &space, const std::string &counts) {
  const std::vector<std::string> entries = split(counts, ',');
  if (static_cast<int>(entries.size()) != space.size())
    throw bad_input("grid:" + counts + " has " + std::to_string(entries.size()) + " counts for " +
                    std::to_string(space.size()) + " free parameters (" + names_of(space) + ")");
  std::vector<Mu> set{{}};
  for (int i = 0; i < space.size(); ++i) {
    const int count =
        parse_count(entries[static_cast<std::size_t>(i)], "grid count of " + space.at(i).name);
    if (set.size() * static_cast<std::size_t>(count) > largest_set)
      throw bad_input("grid:" + counts + " has more than " + std::to_string(largest_set) +
                      " points");
    std::vector<Mu> finer;
    for (const Mu &mu : set)
      for (int k = 0; k < count; ++k) {
        finer.push_back(mu);
        finer.back().push_back(
            at_fraction(space.at(i), count == 1 ? 0.5 : double(k) / (count - 1)));
      }
    set = std::move(finer);
  }
  return set;
}

/// splitmix64 (Steele, Lea, Flood 2014): a counter, mixed; the standard library's distributions
/// differ between machines.
std::uint64_t next_random(std::uint64_t &state) {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

std::vector<Mu> random_set(const ParameterSpace &space, const std::string &text) {
  const std::vector<std::string> entries = split(text, ':');
  if (entries.size() != 2) throw bad_input("'random:" + text + "': write random:COUNT:SEED");
  const int count = parse_count(entries[0], "count of random points");
  const double seed = parse_number(entries[1], "random seed");
  if (seed < 0 || seed > 9e15 || seed != std::floor(seed))
    throw bad_input("random seed " + trimmed(entries[1]) + ": it must be a whole number >= 0");
  auto state = static_cast<std::uint64_t>(seed);
  std::vector<Mu> set(static_cast<std::size_t>(count));
  for (Mu &mu : set)
    for (int i = 0; i < space.size(); ++i)
      mu.push_back(
          at_fraction(space.at(i), static_cast<double>(next_random(state) >> 11) * 0x1p-53));
  return set;
}

/// For each column of the header, the free parameter that it holds.
std::vector<std::size_t> read_header(const ParameterSpace &space, const std::string &line) {
  std::vector<std::size_t> columns;
  for (const std::string &entry : split(line, ',')) {
    const std::string name = trimmed(entry);
    const auto i = find_free(space, name);
    if (!i) throw unknown_parameter(space, name);
    if (std::find(columns.begin(), columns.end(), *i) != columns.end())
      throw bad_input("two columns are named '" + name + "'");
    columns.push_back(*i);
  }
  if (static_cast<int>(columns.size()) != space.size())
    throw bad_input("the header must name every free parameter: " + names_of(space));
  return columns;
}

Mu read_row(const ParameterSpace &space, const std::vector<std::size_t> &columns,
            const std::string &line) {
  const std::vector<std::string> entries = split(line, ',');
  if (entries.size() != columns.size())
    throw bad_input(std::to_string(entries.size()) + " entries under " +
                    std::to_string(columns.size()) + " columns");
  Mu mu(columns.size());
  for (std::size_t k = 0; k < columns.size(); ++k)
    mu[columns[k]] =
        parse_number(entries[k], "parameter " + space.at(static_cast<int>(columns[k])).name);
  return mu;
}

std::vector<Mu> csv_file(const ParameterSpace &space, const std::string &name, bool allow_outside) {
  std::ifstream in(name);
  std::ostringstream text;
  const bool empty = in && in.peek() == EOF && !in.bad();
  if (!empty && !(text << in.rdbuf()))
    throw bad_input("cannot read '" + name + "' (a set is grid:5,5, random:200:1 or a CSV file)");
  std::istringstream lines(text.str());
  std::vector<Mu> set;
  std::vector<std::size_t> columns;
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (number == 1 && line.starts_with("\xef\xbb\xbf")) line.erase(0, 3); // byte order mark
    if (trimmed(line).empty()) continue;
    while_doing("reading line " + std::to_string(number) + " of " + name, [&] {
      if (columns.empty()) {
        columns = read_header(space, line);
      } else {
        set.push_back(read_row(space, columns, line));
        check_mu(space, set.back(), allow_outside);
      }
    });
  }
  if (set.empty()) throw bad_input(name + " has no rows under a header of " + names_of(space));
  return set;
}

} // namespace

std::vector<std::string> split(const std::string &text, char separator) {
  std::vector<std::string> parts;
  if (text.empty()) return parts;
  for (std::size_t begin = 0; begin != std::string::npos;) {
    const std::size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end - begin));
    begin = end == std::string::npos ? end : end + 1;
  }
  return parts;
}

double parse_number(const std::string &text, const std::string &what) {
  std::string digits = trimmed(text);
  if (digits.empty()) throw bad_input(what + " is empty: a number is needed");
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.erase(0, 1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range)
    throw bad_input(what + " is " + digits + ": outside the range of double precision");
  if (error != std::errc() || end != digits.data() + digits.size())
    throw bad_input(what + " is '" + digits + "': not a number");
  if (!std::isfinite(value)) throw bad_input(what + " is " + digits + ": not finite");
  return value;
}

ParameterSpace all_free(std::vector<Parameter> parameters) {
  ParameterSpace space{std::move(parameters), {}};
  for (int i = 0; i < static_cast<int>(space.all.size()); ++i)
    space.free.push_back(i);
  return space;
}

ParameterSpace free_only(const ParameterSpace &space, const std::string &names) {
  ParameterSpace result{space.all, {}};
  for (const std::string &entry : split(names, ',')) {
    const std::string name = trimmed(entry);
    const auto i = find_any(space, name);
    if (!i)
      throw bad_input("there is no parameter '" + name + "'; there are " +
                      names_of(all_free(space.all)));
    result.free.push_back(static_cast<int>(*i));
  }
  if (result.free.empty())
    throw bad_input("no parameter is freed; there are " + names_of(all_free(space.all)));
  std::sort(result.free.begin(), result.free.end());
  const auto twice = std::adjacent_find(result.free.begin(), result.free.end());
  if (twice != result.free.end())
    throw bad_input("parameter '" + space.all[static_cast<std::size_t>(*twice)].name +
                    "' is named twice");
  return result;
}

Mu expand(const ParameterSpace &space, const Mu &mu) {
  Mu values;
  for (const Parameter &parameter : space.all)
    values.push_back(parameter.value);
  for (std::size_t i = 0; i < space.free.size(); ++i)
    values[static_cast<std::size_t>(space.free[i])] = mu.at(i);
  return values;
}

namespace {

bool in_bounds(const Parameter &p, double value) {
  const double slack = 1e-12 * (p.upper - p.lower);
  return value >= p.lower - slack && value <= p.upper + slack;
}

} // namespace

bool in_box(const ParameterSpace &space, const Mu &mu) {
  for (std::size_t i = 0; i < mu.size(); ++i)
    if (!in_bounds(space.at(static_cast<int>(i)), mu[i])) return false;
  return true;
}

void check_mu(const ParameterSpace &space, const Mu &mu, bool allow_outside) {
  if (static_cast<int>(mu.size()) != space.size())
    throw bad_input(std::to_string(mu.size()) + " values for " + std::to_string(space.size()) +
                    " free parameters (" + names_of(space) + ")");
  for (std::size_t i = 0; i < mu.size(); ++i) {
    const Parameter &p = space.at(static_cast<int>(i));
    if (!std::isfinite(mu[i])) throw bad_input("parameter " + p.name + " is not finite");
    if (!allow_outside && !in_bounds(p, mu[i]))
      throw bad_input(p.name + " = " + shortest(mu[i]) + " is outside [" + shortest(p.lower) +
                      ", " + shortest(p.upper) + "]");
    if (!(mu[i] >= p.valid.lower && mu[i] <= p.valid.upper))
      throw bad_input(p.name + " = " + shortest(mu[i]) + " is outside its range of validity [" +
                      shortest(p.valid.lower) + ", " + shortest(p.valid.upper) + "]");
  }
}

Mu parse_mu(const ParameterSpace &space, const std::string &text, bool allow_outside) {
  const std::vector<std::string> entries = split(text, ',');
  Mu mu;
  if (text.find('=') != std::string::npos) {
    mu = parse_named(space, entries);
  } else {
    for (std::size_t i = 0; i < entries.size(); ++i)
      mu.push_back(
          parse_number(entries[i], "value " + std::to_string(i + 1) + " of '" + text + "'"));
  }
  check_mu(space, mu, allow_outside);
  return mu;
}

std::vector<Mu> parse_set(const ParameterSpace &space, const std::string &text,
                          bool allow_outside) {
  if (text.starts_with("grid:")) return grid(space, text.substr(5));
  if (text.starts_with("random:")) return random_set(space, text.substr(7));
  if (!text.empty() && text.find_first_not_of("0123456789") == std::string::npos)
    return random_set(space, text + ":1");
  return csv_file(space, text, allow_outside);
}

std::string describe(const ParameterSpace &space, const Mu &mu) {
  std::string text;
  for (std::size_t i = 0; i < mu.size(); ++i)
    text += (i > 0 ? " " : "") + space.at(static_cast<int>(i)).name + "=" + shortest(mu[i]);
  return text;
}

} // namespace rbvi
