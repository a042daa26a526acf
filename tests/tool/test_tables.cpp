#include "rbvi/tool/tables.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace rbvi::tables_test {
namespace {

Sample sample(double ends_in_contact, double load_steps) {
  Sample result{{1}, {}, {}, {}};
  result.outputs.contact_nodes = 20;
  result.outputs.ends_in_contact = ends_in_contact;
  result.outputs.load_steps = load_steps;
  return result;
}

std::string told(const std::vector<Sample> &samples) {
  std::ostringstream out;
  Scene scene;
  scene.parameters = all_free({{"indentation", "", 0, 2, 1}});
  tell_of_samples(scene, Contact{}, samples, out);
  return out.str();
}

TEST(SamplesOfASweep, AreToldOfWhereSomeTakeLoadStepsOrTouchAnEnd) {
  EXPECT_EQ(told({sample(0, 0), sample(0, 0)}), "");
  EXPECT_EQ(told({sample(0, 8), sample(0, 0)}), "1 of 2 samples took load steps\n");
  const std::string both = told({sample(1, 8), sample(0, 8), sample(2, 0)});
  EXPECT_EQ(both.find("2 of 3 samples took load steps\nwarning: 2 of 3 samples touch an end"), 0U)
      << both;
  EXPECT_NE(both.find("a smaller indentation, offset"), std::string::npos);
  Sample small = sample(0, 0);
  small.outputs.ends_in_contact = small.outputs.load_steps = std::nullopt;
  EXPECT_EQ(told({small}), "") << "of small deformations there is none";
}

TEST(Table, AParameterMayBeCalledLikeAColumn) {
  Table table;
  table.add(all_free({{"pressure", "MPa", 0, 2, 1}, {"x_", "", 0, 1, 0}}), {{1, 0}});
  table.add("interface", std::vector{1.0});
  table.add("pressure", std::vector{3.0});
  EXPECT_EQ(table.names, (std::vector<std::string>{"mu_pressure", "x_", "interface", "pressure"}));
  EXPECT_EQ(table.columns[0].front(), 1);
}

} // namespace
} // namespace rbvi::tables_test
