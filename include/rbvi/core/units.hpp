// Units: numbers such as "205 GPa" in one consistent system, and their dimensions.
//
//   unit = factor { ("*" | "/") factor }      factor = (name | "1") [ "^" integer ]
//
// Names: m N Pa g s K J W with the prefixes n u m c d k M G T; t (1000 kg), deg, rad.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>

namespace rbvi {

/// Powers of length, force, time and temperature. Mass is force time^2 / length.
using Dimension = std::array<int, 4>;

/// Of the units of length, force, time and temperature, the powers of ten of m, N, s and K.
using UnitSystem = std::array<int, 4>;

/// A value in the units of a system.
struct Quantity {
  double value = 0;
  Dimension dimension{};
  bool has_unit = false;
};

/// From {"length", "mm"}, {"force", "N"}; "time" is s and "temperature" K unless declared. Throws
/// bad_input.
UnitSystem unit_system(const std::map<std::string, std::string> &declared);

/// A finite number, with a unit behind it or without one: then the value is as it is. Where a unit
/// is wanted ("": that of the system) the value is in that, and so must be the dimension. Throws
/// bad_input, also for a unit where no system is declared.
Quantity parse_quantity(const std::string &text, const std::optional<UnitSystem> &system,
                        const std::string &wanted = "");

/// The dimension of a product of units: "N/mm^2". Throws bad_input.
Dimension dimension_of(const std::string &unit);

/// What quantities of a dimension are in: "MPa", "N/mm"; "" of none.
std::string unit_in(const UnitSystem &system, const Dimension &dimension);

/// "a stress"; "of dimension force^2*length^-1" where it has no name.
std::string described(const Dimension &dimension);

/// Throws bad_input if a quantity, written as `text`, has a unit of another dimension.
void check_dimension(const Quantity &quantity, const Dimension &wanted, const std::string &text);

/// A number that a run gives, without a unit in `unit` ("": in that of the system), or with one of
/// its dimension: then it becomes one in `unit`. Without a system units are labels. Throws
/// bad_input, which calls it `what`.
double parse_given(const std::string &text, const std::optional<UnitSystem> &system,
                   const std::string &unit, const std::string &what);

/// A value in `unit` as one of the system, and back. Throws bad_input for an unknown unit.
double from_unit(double value, const std::string &unit, const UnitSystem &system);
double into_unit(double value, const std::string &unit, const UnitSystem &system);

/// The unit that is written behind a number; "" of one without, and of other texts.
std::string unit_behind(const std::string &text);

} // namespace rbvi
