#include "rbvi/core/units.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/parameters.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <numeric>

namespace rbvi {

namespace {

/// factor 10^exponent in m, N, s, K. Powers of ten are exact; angles alone have a factor.
struct Unit {
  Dimension dimension{};
  int exponent = 0;
  double factor = 1;
};

const std::array<std::string, 4> base_names{"length", "force", "time", "temperature"};

const std::map<std::string, int> prefixes{{"", 0},   {"n", -9}, {"u", -6}, {"m", -3}, {"c", -2},
                                          {"d", -1}, {"k", 3},  {"M", 6},  {"G", 9},  {"T", 12}};

std::map<std::string, Unit> all_units() {
  const std::map<std::string, Unit> prefixed{
      {"m", {{1}}},       {"N", {{0, 1}}},       {"Pa", {{-2, 1}}}, {"g", {{-1, 1, 2}, -3}},
      {"s", {{0, 0, 1}}}, {"K", {{0, 0, 0, 1}}}, {"J", {{1, 1}}},   {"W", {{1, 1, -1}}}};
  std::map<std::string, Unit> all{
      {"t", {{-1, 1, 2}, 3}}, {"rad", {}}, {"deg", {{}, 0, std::numbers::pi / 180}}, {"1", {}}};
  for (const auto &[name, unit] : prefixed)
    for (const auto &[prefix, exponent] : prefixes)
      all[prefix + name] = {unit.dimension, unit.exponent + exponent};
  return all;
}

Unit parse_unit(const std::string &text) {
  static const std::map<std::string, Unit> known = all_units();
  Unit all;
  for (std::size_t begin = 0, end = 0; begin <= text.size(); begin = end + 1) {
    end = std::min(text.find_first_of("*/", begin), text.size());
    const std::string factor = trimmed(text.substr(begin, end - begin));
    const std::string name = trimmed(factor.substr(0, factor.find('^')));
    const auto unit = known.find(name);
    if (unit == known.end()) {
      std::vector<std::string> names;
      for (const auto &one : known)
        names.push_back(one.first);
      throw bad_input("unknown unit '" + name + "' in '" + text + "': the nearest is '" +
                      nearest_name(name, names) + "' (write kN/mm^2, W/m/K, 1/K)");
    }
    int power = 1;
    if (const auto hat = factor.find('^'); hat != std::string::npos) {
      const std::string digits = trimmed(factor.substr(hat + 1));
      const auto [last, error] =
          std::from_chars(digits.data(), digits.data() + digits.size(), power);
      if (error != std::errc() || last != digits.data() + digits.size() || std::abs(power) > 9)
        throw bad_input("the power '" + digits + "' in the unit '" + text +
                        "' is no integer from -9 to 9");
    }
    if (begin > 0 && text[begin - 1] == '/') power = -power;
    for (std::size_t i = 0; i < 4; ++i)
      all.dimension[i] += power * unit->second.dimension[i];
    all.exponent += power * unit->second.exponent;
    all.factor *= std::pow(unit->second.factor, power);
  }
  return all;
}

/// What a number of the system is in.
Unit of_system(const Dimension &dimension, const UnitSystem &system) {
  return {dimension, std::inner_product(dimension.begin(), dimension.end(), system.begin(), 0), 1};
}

double converted(double number, const Unit &from, const Unit &to) {
  const int exponent = from.exponent - to.exponent;
  const double scale = std::pow(10.0, std::abs(exponent));
  if (from.factor != to.factor) number *= from.factor / to.factor;
  return exponent < 0 ? number / scale : number * scale;
}

/// The number and what is behind it; the whole text and "" where it begins with none.
std::array<std::string, 2> split_unit(const std::string &text) {
  const std::string all = trimmed(text);
  const char *begin = all.data() + all.starts_with('+'), *end = all.data() + all.size();
  double ignored = 0;
  const char *behind = std::from_chars(begin, end, ignored).ptr;
  if (behind == begin) return {all, ""};
  return {std::string(all.data(), behind), trimmed({behind, end})};
}

} // namespace

UnitSystem unit_system(const std::map<std::string, std::string> &declared) {
  UnitSystem system{};
  for (const auto &[name, text] : declared) {
    const auto found = std::find(base_names.begin(), base_names.end(), name);
    if (found == base_names.end())
      throw bad_input("unknown unit of '" + name + "': units are those of " +
                      joined({base_names.begin(), base_names.end()}));
    const auto i = static_cast<std::size_t>(found - base_names.begin());
    const Unit unit = parse_unit(text);
    Dimension wanted{};
    wanted[i] = 1;
    check_dimension({1, unit.dimension, true}, wanted, text);
    system[i] = unit.exponent;
  }
  for (const char *name : {"length", "force"})
    if (!declared.contains(name))
      throw bad_input("units lack that of " + std::string(name) + ": write {length: mm, force: N}");
  return system;
}

Quantity parse_quantity(const std::string &text, const std::optional<UnitSystem> &system,
                        const std::string &wanted) {
  const auto [digits, unit_text] = split_unit(text);
  if (unit_text.empty()) return {parse_number(digits, "a number"), {}, false};
  const double number = parse_number(digits, "the number of '" + trimmed(text) + "'");
  const Unit own = parse_unit(unit_text);
  if (!system)
    throw bad_input("'" + trimmed(text) +
                    "' has a unit, but no units are declared: write units: {length: mm, force: N}");
  const Unit unit = wanted.empty() ? of_system(own.dimension, *system) : parse_unit(wanted);
  const Quantity quantity{converted(number, own, unit), own.dimension, true};
  check_dimension(quantity, unit.dimension, trimmed(text));
  return quantity;
}

double from_unit(double value, const std::string &unit, const UnitSystem &system) {
  const Unit own = parse_unit(unit);
  return converted(value, own, of_system(own.dimension, system));
}

double into_unit(double value, const std::string &unit, const UnitSystem &system) {
  const Unit own = parse_unit(unit);
  return converted(value, of_system(own.dimension, system), own);
}

std::string unit_behind(const std::string &text) {
  const auto [digits, unit] = split_unit(text);
  try {
    if (!unit.empty()) (void)parse_unit(unit);
    return unit;
  } catch (const Error &) { // an expression
    return "";
  }
}

std::string unit_in(const UnitSystem &system, const Dimension &dimension) {
  const std::array<std::pair<std::string, Dimension>, 5> whole{
      {{"m", {1}}, {"N", {0, 1}}, {"s", {0, 0, 1}}, {"K", {0, 0, 0, 1}}, {"Pa", {-2, 1}}}};
  for (const auto &[name, own] : whole) {
    if (own != dimension) continue;
    const int exponent = std::inner_product(own.begin(), own.end(), system.begin(), 0);
    for (const auto &[prefix, power] : prefixes)
      if (power == exponent) return prefix + name;
  }
  std::string above, below; // of the base units
  for (std::size_t i = 0; i < 4; ++i) {
    if (dimension[i] == 0) continue;
    Dimension base{};
    base[i] = 1;
    if (base == dimension) return ""; // its power of ten has no name
    std::string &side = dimension[i] > 0 ? above : below;
    if (dimension[i] < 0)
      side.append("/");
    else if (!side.empty())
      side.append("*");
    side.append(unit_in(system, base));
    if (std::abs(dimension[i]) > 1) side.append("^").append(std::to_string(std::abs(dimension[i])));
  }
  if (above.empty() && !below.empty()) above = "1";
  return above.append(below);
}

Dimension dimension_of(const std::string &unit) {
  return parse_unit(unit).dimension;
}

std::string described(const Dimension &dimension) {
  for (const auto &[unit, name] :
       std::map<std::string, std::string>{{"1", "a number without dimension"},
                                          {"m", "a length"},
                                          {"m^2", "an area"},
                                          {"m^3", "a volume"},
                                          {"1/m", "a curvature"},
                                          {"N", "a force"},
                                          {"Pa", "a stress"},
                                          {"N/m", "a stiffness or a force per length"},
                                          {"N/m^3", "a force per volume"},
                                          {"J", "an energy or a moment"},
                                          {"W", "a power"},
                                          {"s", "a time"},
                                          {"1/s", "a frequency"},
                                          {"m/s", "a velocity"},
                                          {"m/s^2", "an acceleration"},
                                          {"kg", "a mass"},
                                          {"kg/m^3", "a density"},
                                          {"K", "a temperature"},
                                          {"1/K", "a thermal expansion"},
                                          {"W/m/K", "a conductivity"}})
    if (dimension_of(unit) == dimension) return name;
  std::vector<std::string> factors;
  for (std::size_t i = 0; i < 4; ++i)
    if (dimension[i] == 1)
      factors.emplace_back(base_names[i]);
    else if (dimension[i] != 0)
      factors.push_back(
          std::string(base_names[i]).append("^").append(std::to_string(dimension[i])));
  return "of dimension " + joined(factors, "*");
}

void check_dimension(const Quantity &quantity, const Dimension &wanted, const std::string &text) {
  if (quantity.has_unit && quantity.dimension != wanted)
    throw bad_input(described(wanted) + " is wanted, " + text + " is " +
                    described(quantity.dimension));
}

double parse_given(const std::string &text, const std::optional<UnitSystem> &system,
                   const std::string &unit, const std::string &what) {
  const bool has_unit = !split_unit(text)[1].empty();
  if (!has_unit || (!system && trimmed(text).find(' ') == std::string::npos))
    return parse_number(text, what);
  try {
    return parse_quantity(text, system, unit).value;
  } catch (const Error &error) {
    throw bad_input(what + ": " + error.what());
  }
}

} // namespace rbvi
