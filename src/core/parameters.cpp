#include "rbvi/core/parameters.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace rbvi {

namespace {

std::optional<std::size_t> find_any(const ParameterSpace &space, const std::string &name) {
  const auto found = std::find_if(space.all.begin(), space.all.end(),
                                  [&](const Parameter &p) { return p.name == name; });
  if (found == space.all.end()) return std::nullopt;
  return static_cast<std::size_t>(found - space.all.begin());
}

/// Throws bad_input where a choice has no such value.
void check_choice(const Parameter &parameter, double value) {
  if (!parameter.choices.empty() && value != taken(parameter, value))
    throw bad_input("parameter " + parameter.name + " is one of " + joined(parameter.choices) +
                    " (0 to " + std::to_string(parameter.choices.size() - 1) + "), not " +
                    shortest_number(value));
}

std::string text_of(const Parameter &parameter, double value) {
  const bool named = !parameter.choices.empty() && value == taken(parameter, value);
  return named ? parameter.choices[static_cast<std::size_t>(value)] : shortest_number(value);
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
    mu[*i] =
        parse_value(space.at(static_cast<int>(*i)), entry.substr(equals + 1), "parameter " + name);
  }
  return mu;
}

} // namespace

double taken(const Parameter &parameter, double value) {
  if (parameter.choices.empty()) return value;
  return std::clamp(std::round(value), 0.0, static_cast<double>(parameter.choices.size() - 1));
}

double parse_value(const Parameter &parameter, const std::string &text, const std::string &what) {
  const auto named = std::ranges::find(parameter.choices, trimmed(text));
  if (named != parameter.choices.end())
    return static_cast<double>(named - parameter.choices.begin());
  try {
    return parse_number(text, what);
  } catch (const Error &error) {
    if (!parameter.choices.empty())
      throw bad_input(what + " is '" + trimmed(text) + "': it is one of " +
                      joined(parameter.choices));
    if (parameter.unit.empty()) throw;
    throw bad_input(std::string(error.what()).append("; give it in ").append(parameter.unit));
  }
}

std::string names_of(const ParameterSpace &space) {
  std::string names;
  for (int i = 0; i < space.size(); ++i)
    names += (i > 0 ? "," : "") + space.at(i).name;
  return names;
}

std::optional<std::size_t> find_free(const ParameterSpace &space, const std::string &name) {
  for (int i = 0; i < space.size(); ++i)
    if (space.at(i).name == name) return static_cast<std::size_t>(i);
  return std::nullopt;
}

Error unknown_parameter(const ParameterSpace &space, const std::string &name) {
  if (find_any(space, name))
    return bad_input("parameter '" + name + "' is fixed; the free ones are " + names_of(space));
  return bad_input("there is no parameter '" + name + "'; the free ones are " + names_of(space));
}

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

std::vector<std::string> names_in(const std::string &text) {
  std::vector<std::string> names = split(text, ',');
  for (std::string &name : names)
    name = trimmed(name);
  return names;
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
    const auto position = static_cast<int>(*i);
    if (std::ranges::find(result.free, position) != result.free.end())
      throw bad_input("parameter '" + name + "' is named twice");
    result.free.push_back(position);
  }
  if (result.free.empty())
    throw bad_input("no parameter is freed; there are " + names_of(all_free(space.all)));
  return result;
}

FullMu expand(const ParameterSpace &space, const Mu &mu) {
  FullMu values;
  for (const Parameter &parameter : space.all)
    values.push_back(parameter.value);
  for (std::size_t i = 0; i < space.free.size(); ++i)
    values[space.free[i]] = mu.at(i);
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
    throw bad_input(counted(std::ssize(mu), "value") + " for " +
                    counted(space.size(), "free parameter") + " (" + names_of(space) + ")");
  for (std::size_t i = 0; i < mu.size(); ++i) {
    const Parameter &p = space.at(static_cast<int>(i));
    if (!std::isfinite(mu[i])) throw bad_input("parameter " + p.name + " is not finite");
    check_choice(p, mu[i]);
    if (!allow_outside && !in_bounds(p, mu[i]))
      throw bad_input(p.name + " = " + shortest_number(mu[i]) + " is outside [" +
                      shortest_number(p.lower) + ", " + shortest_number(p.upper) + "]");
    if (!(mu[i] >= p.valid.lower && mu[i] <= p.valid.upper))
      throw bad_input(p.name + " = " + shortest_number(mu[i]) +
                      " is outside its range of validity [" + shortest_number(p.valid.lower) +
                      ", " + shortest_number(p.valid.upper) + "]");
  }
}

Mu parse_mu(const ParameterSpace &space, const std::string &text, bool allow_outside) {
  const std::vector<std::string> entries = split(text, ',');
  Mu mu;
  if (text.find('=') != std::string::npos) {
    mu = parse_named(space, entries);
  } else {
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const std::string what = "value " + std::to_string(i + 1) + " of '" + text + "'";
      const bool has_place = static_cast<int>(i) < space.size(); // else there are too many
      mu.push_back(has_place ? parse_value(space.at(static_cast<int>(i)), entries[i], what)
                             : parse_number(entries[i], what));
    }
  }
  check_mu(space, mu, allow_outside);
  return mu;
}

std::string describe(const ParameterSpace &space, const Mu &mu) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < mu.size(); ++i)
    parts.push_back(space.at(static_cast<int>(i)).name + "=" +
                    text_of(space.at(static_cast<int>(i)), mu[i]));
  return joined(parts, " ");
}

std::string describe(const ParameterSpace &space, const FullMu &mu) {
  return describe(all_free(space.all), Mu(mu));
}

} // namespace rbvi
