#include "rbvi/core/units.hpp"

#include "refuses.hpp"

#include <cmath>

namespace rbvi::units_test {
namespace {

TEST(Units, ConvertInto) {
  const UnitSystem mm = unit_system({{"length", "mm"}, {"force", "N"}});
  const std::vector<std::pair<std::string, double>> table{{"50 kN", 50000},
                                                          {"1800 kN/mm", 1.8e6},
                                                          {"205 GPa", 205000},
                                                          {"0.5 MPa", 0.5},
                                                          {"1 m^2", 1e6},
                                                          {"1 t", 1},
                                                          {"7850 kg/m^3", 7.85e-9},
                                                          {"9.81 m/s^2", 9810},
                                                          {"3 1/K", 3},
                                                          {"1 J", 1000},
                                                          {"50 W/m/K", 50},
                                                          {"2 N*m", 2000},
                                                          {"180 deg", 3.141592653589793},
                                                          {"+1 um", 1e-3},
                                                          {"-3 cm", -30},
                                                          {"1 m^-1", 1e-3},
                                                          {"20mm", 20}};
  for (const auto &[text, expected] : table) {
    EXPECT_DOUBLE_EQ(parse_quantity(text, mm).value, expected) << text;
    EXPECT_TRUE(parse_quantity(text, mm).has_unit);
  }
  EXPECT_EQ(parse_quantity("205 GPa", unit_system({{"length", "m"}, {"force", "MN"}})).value,
            205000);
  EXPECT_EQ(
      parse_quantity("1 s", unit_system({{"length", "m"}, {"force", "N"}, {"time", "ms"}})).value,
      1000);
  EXPECT_FALSE(parse_quantity("5", mm).has_unit);
  EXPECT_EQ(parse_quantity(" 1e-3 ", std::nullopt).value, 1e-3);
}

TEST(Units, HaveDimensionsAndErrorsThatNameThem) {
  const UnitSystem mm = unit_system({{"length", "mm"}, {"force", "N"}});
  EXPECT_EQ(described(dimension_of("kN/mm^2")), "a stress");
  EXPECT_EQ(described(dimension_of("g/mm^3")), "a density");
  EXPECT_EQ(described(dimension_of("N^2/m")), "of dimension length^-1*force^2");
  EXPECT_TRUE(refuses("a stress is wanted, 5 mm is a length", [&] {
    check_dimension(parse_quantity("5 mm", mm), dimension_of("Pa"), "5 mm");
  }));
  check_dimension(parse_quantity("5", mm), dimension_of("Pa"), "5");
  check_dimension(parse_quantity("5 N/mm^2", mm), dimension_of("Pa"), "5 N/mm^2");
  for (const auto &[text, words] : std::vector<std::pair<std::string, std::string>>{
           {"5 Mpa", "unknown unit 'Mpa' in 'Mpa': the nearest is 'MPa'"},
           {"5 kN mm", "unknown unit 'kN mm'"},
           {"5 m^x", "the power 'x'"},
           {"5 m/", "unknown unit ''"},
           {"mm", "not a number"},
           {"", "is empty"}})
    EXPECT_TRUE(refuses(words, [&, &t = text] { parse_quantity(t, mm); })) << text;
  EXPECT_TRUE(refuses("no units are declared", [] { parse_quantity("5 mm", std::nullopt); }));
  EXPECT_TRUE(refuses("lack that of force", [] { unit_system({{"length", "mm"}}); }));
  EXPECT_TRUE(refuses("a length is wanted, N is a force", [] { unit_system({{"length", "N"}}); }));
  EXPECT_TRUE(refuses("unknown unit of 'mass'", [] { unit_system({{"mass", "kg"}}); }));
}

TEST(Units, HaveNamesInASystem) {
  const UnitSystem mm = unit_system({{"length", "mm"}, {"force", "N"}}),
                   si = unit_system({{"length", "m"}, {"force", "N"}}),
                   odd = unit_system({{"length", "cm"}, {"force", "kN"}});
  for (const auto &[unit, name] : std::map<std::string, std::string>{{"m", "mm"},
                                                                     {"GPa", "MPa"},
                                                                     {"kN", "N"},
                                                                     {"N/m", "N/mm"},
                                                                     {"N/m^3", "N/mm^3"},
                                                                     {"1/K", "1/K"},
                                                                     {"N*m", "mm*N"},
                                                                     {"deg", ""},
                                                                     {"s", "s"}})
    EXPECT_EQ(unit_in(mm, dimension_of(unit)), name) << unit;
  EXPECT_EQ(unit_in(si, dimension_of("MPa")), "Pa");
  EXPECT_EQ(unit_in(odd, dimension_of("Pa")), "kN/cm^2") << "1e7 Pa has no name";
  for (const std::string unit : {"m", "Pa", "N/m"}) {
    const Quantity one = parse_quantity("1 " + unit_in(odd, dimension_of(unit)), odd);
    EXPECT_DOUBLE_EQ(one.value, 1);
    EXPECT_EQ(one.dimension, dimension_of(unit));
  }
}

TEST(Units, ConvertAValueThereAndBack) {
  const UnitSystem mm = unit_system({{"length", "mm"}, {"force", "kN"}});
  for (const auto &[unit, size] : std::map<std::string, double>{
           {"um", 1e-3}, {"m", 1e3}, {"GPa", 1}, {"MPa", 1e-3}, {"deg", M_PI / 180}, {"K", 1}}) {
    EXPECT_DOUBLE_EQ(from_unit(1, unit, mm), size) << unit;
    EXPECT_DOUBLE_EQ(into_unit(from_unit(0.37, unit, mm), unit, mm), 0.37) << unit;
  }
  EXPECT_EQ(from_unit(50, "um", mm), 0.05);
  EXPECT_EQ(unit_behind("5 um") + unit_behind("-3e-2MPa") + unit_behind("+1 N/mm^2"),
            "umMPaN/mm^2");
  for (const char *text : {"5", "2*pi", "um", "3 - 1", "1/3", "5 foo", ""})
    EXPECT_EQ(unit_behind(text), "") << text;
}

TEST(Units, OfWhatARunGives) {
  const UnitSystem mm = unit_system({{"length", "mm"}, {"force", "N"}});
  EXPECT_EQ(parse_given("2 GPa", mm, "MPa", "option -young"), 2000);
  EXPECT_EQ(parse_given("2 MPa", mm, "GPa", "option -young"), 0.002);
  EXPECT_EQ(parse_given("2", mm, "GPa", "option -young"), 2) << "in the unit of the parameter";
  EXPECT_EQ(parse_given("35 um", mm, "um", "option -depth"), 35);
  EXPECT_NEAR(parse_given("0.5 rad", mm, "deg", "option -tilt"), 90 / M_PI, 1e-14);
  EXPECT_EQ(parse_given("+2GPa", mm, "", "option -young"), 2000);
  EXPECT_EQ(parse_given(" 1e-3", std::nullopt, "MPa", "option -young"), 1e-3);
  const auto refused = [&](const std::string &text, const std::optional<UnitSystem> &system,
                           const std::string &says) {
    return refuses(says, [&] { (void)parse_given(text, system, "MPa", "option -young"); });
  };
  EXPECT_TRUE(refused("2 mm", mm, "option -young: a stress is wanted, 2 mm is a length"));
  EXPECT_TRUE(refused("2 MPb", mm, "option -young: unknown unit 'MPb'"));
  EXPECT_TRUE(refused("stiff", mm, "option -young is 'stiff': not a number"));
  EXPECT_TRUE(refused("2x", std::nullopt, "option -young is '2x': not a number"));
  EXPECT_TRUE(refused("2 MPa", std::nullopt, "option -young: '2 MPa' has a unit, but no units"));
}

} // namespace
} // namespace rbvi::units_test
