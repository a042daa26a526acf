#include "refuses.hpp"

#include "rbvi/core/box.hpp"
#include "rbvi/io/parameter_sets.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <unistd.h>

namespace rbvi::parameters_test {
namespace {

ParameterSpace space() {
  return all_free({{"radius", "m", 0.16, 0.24, 0.2}, {"x", "m", -0.05, 0.05, 0}});
}

ParameterSpace only_x() {
  return free_only(space(), "x");
}

TEST(ParseNumber, WholeFiniteText) {
  EXPECT_EQ(parse_number(" -0.5e-3\r", "x"), -0.5e-3);
  EXPECT_EQ(parse_number("+2", "x"), 2);
  for (const char *text : {"", " ", "nan", "inf", "-infinity", "1e999", "1,5", "0.2m", "0x1p3",
                           "1 2", "+-1", "--1", "+", "e5"})
    EXPECT_TRUE(refuses("load", [&] { (void)parse_number(text, "load"); })) << text;
}

TEST(Split, KeepsEmptyParts) {
  EXPECT_TRUE(split("", ',').empty());
  EXPECT_EQ(split("a", ','), (std::vector<std::string>{"a"}));
  EXPECT_EQ(split(",b,", ','), (std::vector<std::string>{"", "b", ""}));
}

TEST(ParseMu, InOrderOrByName) {
  EXPECT_EQ(parse_mu(space(), "0.18, 0.02"), (Mu{0.18, 0.02}));
  EXPECT_EQ(parse_mu(space(), "x=-0.01"), (Mu{0.2, -0.01}));
  EXPECT_EQ(parse_mu(space(), "x=-0.01, radius=0.24"), (Mu{0.24, -0.01}));
  EXPECT_EQ(parse_mu(space(), "0.5,0", true), (Mu{0.5, 0}));
  EXPECT_EQ(parse_mu(only_x(), "0.02"), (Mu{0.02}));
  EXPECT_EQ(expand(only_x(), {0.02}), (Mu{0.2, 0.02}));
}

TEST(ParseMu, RefusesWhatIsWrong) {
  const auto refused = [](const std::string &text, const std::string &part) {
    return refuses(part, [&] { (void)parse_mu(space(), text); });
  };
  EXPECT_TRUE(refused("", "0 values for 2"));
  EXPECT_TRUE(refused("0.2", "1 value for 2"));
  EXPECT_TRUE(refused("0.2,0,0", "3 values for 2"));
  EXPECT_TRUE(refused("0.2,", "empty"));
  EXPECT_TRUE(refused("nan,0", "not finite"));
  EXPECT_TRUE(refused("a,0", "not a number"));
  EXPECT_TRUE(refused("0.2,0.06", "x = 0.06 is outside [-0.05, 0.05]"));
  EXPECT_TRUE(refused("y=1", "no parameter 'y'"));
  EXPECT_TRUE(refused("x=0,x=0", "given twice"));
  EXPECT_TRUE(refused("x=0,0.2", "no name"));
  ParameterSpace metres = space();
  metres.all.front().unit = "m";
  for (const char *text : {"20 cm,0", "radius=20 cm"})
    EXPECT_TRUE(
        refuses("'20 cm': not a number; give it in m", [&] { (void)parse_mu(metres, text); }));
  EXPECT_TRUE(refuses("is fixed", [] { (void)parse_mu(only_x(), "radius=0.2"); }));
}

TEST(CheckMu, BoxWithSlackOfRoundOff) {
  EXPECT_NO_THROW(check_mu(space(), {0.24 + 1e-14, -0.05 - 1e-14}));
  EXPECT_THROW(check_mu(space(), {0.24 + 1e-12, 0}), Error);
  EXPECT_NO_THROW(check_mu(space(), {9, 9}, true));
  EXPECT_THROW(check_mu(space(), {std::numeric_limits<double>::quiet_NaN(), 0}, true), Error);
  EXPECT_FALSE(in_box(space(), {0.2, 1}));
  EXPECT_TRUE(in_box(space(), {0.2, 0.05}));
}

TEST(FreeOnly, ByNameInTheOrderThatIsAskedFor) {
  EXPECT_EQ(free_only(space(), "radius,x").free, (std::vector<int>{0, 1}));
  const ParameterSpace turned = free_only(space(), "x,radius");
  EXPECT_EQ(turned.free, (std::vector<int>{1, 0}));
  EXPECT_EQ(names_of(turned), "x,radius");
  EXPECT_EQ(parse_mu(turned, "0.02,0.18"), (Mu{0.02, 0.18}));
  EXPECT_EQ(parse_mu(turned, "radius=0.18,x=0.02"), (Mu{0.02, 0.18}));
  EXPECT_EQ(expand(turned, {0.02, 0.18}), (FullMu{0.18, 0.02}));
  EXPECT_EQ(describe(turned, Mu{0.02, 0.18}), "x=0.02 radius=0.18");
  const std::vector<Mu> grid = parse_set(turned, "grid:3,2");
  ASSERT_EQ(grid.size(), 6u);
  EXPECT_EQ(grid[0], (Mu{-0.05, 0.16}));
  EXPECT_EQ(grid[1], (Mu{-0.05, 0.24}));
  EXPECT_TRUE(refuses("no parameter 'z'", [] { (void)free_only(space(), "z"); }));
  EXPECT_TRUE(refuses("named twice", [] { (void)free_only(space(), "x,x"); }));
  EXPECT_TRUE(refuses("no parameter is freed", [] { (void)free_only(space(), ""); }));
}

TEST(Grid, EndsIncludedLastFastest) {
  const std::vector<Mu> set = parse_set(space(), "grid:3,2");
  ASSERT_EQ(set.size(), 6U);
  EXPECT_EQ(set[0], (Mu{0.16, -0.05}));
  EXPECT_EQ(set[1], (Mu{0.16, 0.05}));
  EXPECT_EQ(set[5], (Mu{0.24, 0.05}));
  EXPECT_NEAR(set[2][0], 0.2, 1e-16);
  EXPECT_NEAR(parse_set(space(), "grid:1,1")[0][0], 0.2, 1e-16);
  for (const char *text : {"grid:", "grid:3", "grid:3,3,3", "grid:0,3", "grid:2.5,3", "grid:-1,3",
                           "grid:100000,100000"})
    EXPECT_TRUE(refuses("", [&] { (void)parse_set(space(), text); })) << text;
}

TEST(RandomSet, UniformInTheBoxAndTheSameEverywhere) {
  const std::vector<Mu> set = parse_set(space(), "random:4000:1");
  EXPECT_EQ(set, parse_set(space(), "random:4000:1"));
  EXPECT_NE(set, parse_set(space(), "random:4000:2"));
  EXPECT_EQ(set, parse_set(space(), "4000"));
  double mean = 0, square = 0, product = 0;
  for (const Mu &mu : set) {
    check_mu(space(), mu);
    const double s = (mu[0] - 0.2) / 0.04, t = mu[1] / 0.05;
    mean += s / 4000;
    square += s * s / 4000;
    product += s * t / 4000;
  }
  // Standard deviations of these means: 0.009, 0.005, 0.005.
  EXPECT_NEAR(mean, 0, 0.04);
  EXPECT_NEAR(square, 1.0 / 3, 0.02);
  EXPECT_NEAR(product, 0, 0.02);
  // splitmix64 from state 0 begins with 0xe220a8397b1dcdaf (the author's reference output).
  const double first = std::ldexp(static_cast<double>(0xe220a8397b1dcdafULL >> 11), -53);
  EXPECT_NEAR(parse_set(space(), "random:1:0")[0][0], 0.16 + 0.08 * first, 1e-16);
  for (const char *text :
       {"random:5", "random:5:", "random:0:1", "random:5:-1", "random:5:1:1", "random:5:0.5"})
    EXPECT_TRUE(refuses("", [&] { (void)parse_set(space(), text); })) << text;
}

struct CsvSet : testing::Test {
  std::string name = testing::TempDir() + "rbvi_set_" + std::to_string(::getpid()) + ".csv";
  void TearDown() override { std::filesystem::remove(name); }
  std::vector<Mu> read(const std::string &text) {
    std::ofstream(name, std::ios::binary) << text;
    return parse_set(space(), name);
  }
};

TEST_F(CsvSet, ColumnsInAnyOrder) {
  EXPECT_EQ(read("\xef\xbb\xbfx, radius\r\n0.01,0.2\r\n\r\n-0.01,0.16\r\n"),
            (std::vector<Mu>{{0.2, 0.01}, {0.16, -0.01}}));
}

TEST_F(CsvSet, PassesOverTheOtherColumnsOfATable) {
  EXPECT_EQ(read("radius,energy,energy_error,x,status\n0.2,7,1e-5,0.01,ok\n"
                 "0.16,,,0,\"no answer, \"\"here\"\"\"\n"),
            (std::vector<Mu>{{0.2, 0.01}, {0.16, 0}}));
}

TEST_F(CsvSet, PassesOverOutputsOfTheSceneAlone) {
  std::ofstream(name) << "radius,push,x,push_error\n0.2,7,0.01,1e-3\n0.16,,0,\n";
  std::vector<OutputForm> own(1);
  own.front().name = "push";
  EXPECT_EQ(parse_set(space(), name, false, own), (std::vector<Mu>{{0.2, 0.01}, {0.16, 0}}));
  own.front().name = "pull";
  EXPECT_TRUE(refuses("push", [&] { (void)parse_set(space(), name, false, own); }));
}

TEST_F(CsvSet, IsReadRowByRowAndGoesOnBehindAWrongOne) {
  std::ofstream(name) << "radius,x\n0.2,0\n0.9,0\n0.16,0.01\n";
  const ParameterSpace box = space();
  ParameterReader reader(box, name);
  EXPECT_EQ(reader.next(), (Mu{0.2, 0}));
  EXPECT_TRUE(refuses("line 3", [&] { (void)reader.next(); }));
  EXPECT_EQ(reader.next(), (Mu{0.16, 0.01}));
  EXPECT_EQ(reader.next(), std::nullopt);
  EXPECT_EQ(reader.next(), std::nullopt);
  EXPECT_FALSE(is_stream(name));
  EXPECT_TRUE(is_stream("-"));
  EXPECT_TRUE(is_stream("/dev/null"));
  EXPECT_FALSE(is_stream("grid:2,2"));
}

TEST(ParameterSet, OfCornersAndOfSeveralSets) {
  ParameterSpace space;
  space.all = {{"a", "", 0, 1, 0}, {"b", "", 2, 4, 2}};
  space.free = {0, 1};
  const std::vector<Mu> corners = parse_set(space, "corners");
  EXPECT_EQ(corners, corners_and_faces(space));
  ASSERT_EQ(corners.size(), 8U);
  std::vector<Mu> all = corners;
  for (const Mu &mu : parse_set(space, "random:3:7"))
    all.push_back(mu);
  all.push_back({0.5, 3});
  EXPECT_EQ(parse_set(space, "corners + random:3:7 + grid:1,1"), all);
  EXPECT_THROW(parse_set(space, "corners + "), Error);
  EXPECT_THROW(parse_set(space, "corners + -"), Error);
  EXPECT_THROW(parse_set(space, "corners + a.csv"), Error);
  EXPECT_FALSE(is_set_file("corners") || is_set_file("corners + random:3:7"));
  EXPECT_TRUE(is_set_file("corners.csv"));
}

/// The published radii, 0.7 + 0.0075 i for i <= 60, in a box that goes on to 1.3.
TEST(ParameterSet, OfAPartOfTheBox) {
  ParameterSpace space;
  space.all = {{"a", "", 0.7, 1.3, 1}, {"b", "", 2, 4, 2}};
  space.free = {0, 1};
  const std::vector<Mu> whole = parse_set(space, "grid:81,2"),
                        part =
                            parse_set(space, "grid:61,2 in a=0.7,1.15 + random:50:3 in b = 3, 4");
  ASSERT_EQ(part.size(), 172U);
  for (std::size_t k = 0; k < 122; ++k) {
    EXPECT_NEAR(part[k][0], whole[k][0], 1e-14);
    EXPECT_EQ(part[k][1], whole[k][1]);
  }
  const auto low = [](const Mu &a, const Mu &b) { return a[1] < b[1]; };
  const auto [lowest, highest] = std::minmax_element(part.begin() + 122, part.end(), low);
  EXPECT_TRUE((*lowest)[1] >= 3 && (*lowest)[1] < 3.2 && (*highest)[1] > 3.8);
  EXPECT_FALSE(is_set_file("grid:61,2 in a=0.7,1.15"));
  for (const char *wrong : {"a=0.6,1", "a=1,0.8", "a=1,1.4", "a=1", "a", "c=0,1", "a=x,1"})
    EXPECT_TRUE(refuses("", [&] { (void)parse_set(space, std::string("grid:3,2 in ") + wrong); }))
        << wrong;
}

TEST(ParameterReader, GivesTheSetsOneByOne) {
  const ParameterSpace box = space();
  for (const char *text : {"grid:3,2", "random:5:2"}) {
    ParameterReader reader(box, text);
    for (const Mu &mu : parse_set(box, text))
      EXPECT_EQ(reader.next(), mu) << text;
    EXPECT_EQ(reader.next(), std::nullopt);
  }
}

TEST_F(CsvSet, RefusesWhatIsWrong) {
  const auto refused = [&](const std::string &text, const std::string &part) {
    return refuses(part, [&] { (void)read(text); });
  };
  EXPECT_TRUE(refused("", "no rows"));
  EXPECT_TRUE(refused("radius,x\n", "no rows"));
  EXPECT_TRUE(refused("radius\n0.2\n", "every free parameter"));
  EXPECT_TRUE(refused("radius,y\n0.2,0\n", "no parameter 'y'"));
  EXPECT_TRUE(refused("radius,x,x\n0.2,0,0\n", "two columns"));
  EXPECT_TRUE(refused("radius,x,energie\n0.2,0,1\n", "no parameter 'energie'"));
  EXPECT_TRUE(refused("radius,x,status\n0.2,0,\"ok\n", "line 2"));
  EXPECT_TRUE(refused("radius,x\n0.2,0\n0.2\n", "line 3"));
  EXPECT_TRUE(refused("radius,x\n0.2,0,1\n", "3 entries under 2 columns, while reading line 2"));
  EXPECT_TRUE(refused("radius,x\n0.2,0\n\n0.2,oops\n", "line 4"));
  EXPECT_TRUE(refused("radius,x\n0.2,nan\n", "not finite"));
  EXPECT_TRUE(refused("radius,x\n0.3,0\n", "outside"));
  EXPECT_TRUE(refuses("cannot read", [&] { (void)parse_set(space(), name + ".no"); }));
  EXPECT_TRUE(refuses("cannot read", [&] { (void)parse_set(space(), testing::TempDir()); }));
}

/// One of three metals beside a length.
ParameterSpace with_choice() {
  Parameter metal{"metal", "", 0, 2, 1};
  metal.choices = {"steel", "brass", "lead"};
  return all_free({{"length", "m", 1, 2, 1.5}, metal});
}

TEST(Choice, IsGivenByNameOrNumberAndHasNoOtherValues) {
  EXPECT_EQ(parse_mu(with_choice(), "metal=lead"), (Mu{1.5, 2}));
  EXPECT_EQ(parse_mu(with_choice(), "1, brass"), (Mu{1, 1}));
  EXPECT_EQ(parse_mu(with_choice(), "1, 0"), (Mu{1, 0}));
  EXPECT_EQ(describe(with_choice(), Mu{1.5, 2}), "length=1.5 metal=lead");
  EXPECT_EQ(parse_mu(with_choice(), "length=1.5,metal=lead"), (Mu{1.5, 2}));
  const auto refused = [](const std::string &text, const std::string &part) {
    return refuses(part, [&] { (void)parse_mu(with_choice(), text, true); });
  };
  EXPECT_TRUE(refused("metal=iron", "one of steel, brass, lead"));
  EXPECT_TRUE(refused("metal=0.5", "one of steel, brass, lead (0 to 2), not 0.5"));
  EXPECT_TRUE(refused("metal=3", "not 3"));
}

TEST(Choice, IsTakenByEverySet) {
  const auto metals = [](const std::string &set) {
    std::vector<int> count(3);
    for (const Mu &mu : parse_set(with_choice(), set)) {
      EXPECT_EQ(mu[1], taken(with_choice().at(1), mu[1])) << set;
      ++count[static_cast<std::size_t>(mu[1])];
    }
    return count;
  };
  EXPECT_EQ(metals("grid:2,3"), (std::vector<int>{2, 2, 2}));
  EXPECT_EQ(metals("grid:2,2"), (std::vector<int>{2, 0, 2}));
  EXPECT_EQ(metals("corners"), (std::vector<int>{3, 2, 3})) << "and centres of faces";
  for (const int count : metals("random:3000:1"))
    EXPECT_NEAR(count, 1000, 100);
  EXPECT_TRUE(refuses("4 values of metal, which has 3",
                      [&] { (void)parse_set(with_choice(), "grid:2,4"); }));
}

TEST(Describe, ReadsBackExactly) {
  EXPECT_EQ(describe(space(), Mu{0.18, -0.02}), "radius=0.18 x=-0.02");
  const double third = 0.17 + 0.01 / 3;
  const std::string text = describe(only_x(), Mu{third});
  EXPECT_EQ(parse_number(text.substr(2), "x"), third);
}

} // namespace
} // namespace rbvi::parameters_test
