#include "rbvi/core/error.hpp"
#include "rbvi/core/outputs.hpp"

#include <gtest/gtest.h>
#include <sstream>

namespace rbvi {
namespace {

TEST(WriteCsv, ColumnsThatAreSetInTheAgreedOrder) {
  const ParameterSpace space = all_free({{"radius", "m", 0, 1, 0}, {"x", "", 0, 1, 0}});
  Outputs one, two;
  one.seconds = 0.5;
  one.energy = -1.0 / 3;
  two = one;
  two.min_u = -2;
  std::ostringstream out;
  write_csv(out, space, {{0.1, 1}, {0.17 + 0.01 / 3, 0}}, {one, two});
  EXPECT_EQ(out.str(), "radius,x,energy,min_u,seconds\n"
                       "0.1,1,-0.3333333333,,0.5\n"
                       "0.17333333333333334,0,-0.3333333333,-2,0.5\n");
}

TEST(WriteCsv, RefusesTablesOfTwoLengths) {
  std::ostringstream out;
  EXPECT_THROW(write_csv(out, all_free({{"x", "", 0, 1, 0}}), {{0.5}}, {}), Error);
}

TEST(PrintOutputs, OneLineForEach) {
  Outputs outputs;
  outputs.normal_force = 2;
  outputs.iterations = 7;
  std::ostringstream out;
  print_outputs(out, outputs);
  std::istringstream in(out.str());
  std::string name;
  double value = 0;
  in >> name >> value;
  EXPECT_EQ(name, "normal_force");
  EXPECT_EQ(value, 2);
  in >> name >> value;
  EXPECT_EQ(name, "iterations");
  EXPECT_EQ(value, 7);
  EXPECT_FALSE(in >> name);
}

} // namespace
} // namespace rbvi
