#include "rbvi/core/error.hpp"
#include "rbvi/core/outputs.hpp"
#include "rbvi/core/warnings.hpp"
#include "rbvi/io/output_table.hpp"

#include <cstddef>
#include <gtest/gtest.h>
#include <set>
#include <sstream>

namespace rbvi::outputs_test {
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

TEST(OutputTable, ErrorsStandBesideTheirOutputsAndFailuresSayWhy) {
  const ParameterSpace space = all_free({{"radius", "m", 0, 1, 0}});
  Outputs like;
  like.energy = like.kkt_residual = 0;
  std::ostringstream out;
  OutputTable table(out, space, like,
                    {{{"energy", 1.23e-5}, {"min_u", 1}}, true, 3, {"id", "time"}});
  Outputs row;
  row.energy = 0.12345678901;
  row.kkt_residual = 1e-15;
  table.add({0.25}, row, true, {"a,b", "0.5"});
  table.add({2}, row, false);
  table.add_failure(row_of({0.5}, {"7", "1"}), "it \"fails\", here\nand there");
  table.add_failure({{"8"}, {"one, two"}}, "not a number");
  table.add_failure({}, "nothing");
  EXPECT_EQ(out.str(), "id,time,radius,energy,energy_error,kkt_residual,status\n"
                       "\"a,b\",0.5,0.25,0.123,1.2e-05,1e-15,ok\n"
                       ",,2,0.123,,1e-15,ok\n"
                       "7,1,0.5,,,,\"it \"\"fails\"\", here and there\"\n"
                       "8,,\"one, two\",,,,\"not a number\"\n"
                       ",,,,,,\"nothing\"\n");
}

TEST(OutputColumns, EachHasANameOfItsOwnAndADefinition) {
  std::set<std::string> names;
  for (const OutputColumn &column : output_columns()) {
    EXPECT_TRUE(names.insert(column.name).second) << column.name;
    EXPECT_GT(std::string(column.says).size(), 10U) << column.name;
    EXPECT_TRUE(is_table_column(column.name));
    EXPECT_TRUE(is_table_column(std::string(column.name) + "_error"));
  }
  EXPECT_TRUE(is_table_column("status"));
  EXPECT_FALSE(is_table_column("radius"));
}

/// Samples, columns and sums over contacts see what is in the table.
TEST(NumbersOfOutputs, AreAllMembersAndComeBack) {
  const std::size_t members = offsetof(Outputs, named) / sizeof(std::optional<double>);
  std::vector<std::optional<double>> numbers(members);
  for (std::size_t i = 0; i < members; i += 2)
    numbers[i] = 1.5 * static_cast<double>(i);
  Outputs outputs;
  ASSERT_EQ(numbers_of(outputs).size(), members);
  set_numbers(numbers, outputs);
  EXPECT_EQ(numbers_of(outputs), numbers);
  numbers.pop_back();
  EXPECT_THROW(set_numbers(numbers, outputs), Error);
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

Outputs zones(double contact, double stick, double tangential_force) {
  Outputs outputs;
  outputs.contact_nodes = contact;
  outputs.stick_nodes = stick;
  outputs.tangential_force = tangential_force;
  return outputs;
}

TEST(ResolutionWarning, NamesTheZoneThatIsTooSmall) {
  const auto says = [](const Outputs &outputs, const std::string &part) {
    return resolution_warning(outputs).find(part) != std::string::npos;
  };
  EXPECT_TRUE(says(zones(8, 6, 1), "only 8 nodes are in contact"));
  EXPECT_FALSE(says(zones(8, 6, 1), "tangential_force"));
  Outputs one_way = zones(4, 4, 1); // the stress of a node is undecided there, too
  one_way.slip_directions = 1;
  EXPECT_TRUE(says(one_way, "tangential_force may be off by 3.8e-01"));
  Outputs off_its_law = zones(20, 20, 1);
  off_its_law.law_error_normal = 0.1;
  EXPECT_FALSE(says(off_its_law, "law"));
  off_its_law.law_error_normal = 0.47;
  EXPECT_TRUE(says(off_its_law, "law_error_normal is 0.47"));
  EXPECT_TRUE(says(zones(20, 1, 1), "only 1 of 20 nodes in contact stick"));
  EXPECT_TRUE(says(zones(20, 1, 1), "tangential_force may be off by 7.5e-02"));
  EXPECT_FALSE(says(zones(20, 1, 1), ": forces"));
  EXPECT_TRUE(says(zones(5, 0, 1), "tangential_force may be off by 3.0e-01"));
  EXPECT_TRUE(says(zones(5, 0, 1), ": forces"));
  Outputs frictionless;
  frictionless.contact_nodes = 8;
  EXPECT_TRUE(says(frictionless, "only 8 nodes"));
}

/// Contact everywhere has no edge that a mesh could miss, and full slip in one direction does not
/// turn.
TEST(ResolutionWarning, IsEmptyWhereNoZoneEnds) {
  Outputs outputs = zones(5, 5, 1);
  outputs.free_nodes = 0;
  EXPECT_EQ(resolution_warning(outputs), "");
  outputs.free_nodes = 1;
  EXPECT_NE(resolution_warning(outputs), "");
  outputs = zones(20, 0, 1);
  outputs.slip_directions = 1;
  EXPECT_EQ(resolution_warning(outputs), "");
  outputs.slip_directions = 2;
  EXPECT_NE(resolution_warning(outputs), "");
}

/// Once a run, with the number of answers.
TEST(ValidityWarning, IsToldOfTheFirstAnswerThatSmallKinematicsDoNotHoldFor) {
  Outputs right, far, strained;
  right.gap_error = 0.04;
  right.strained = 0.005;
  far.gap_error = 0.235;
  strained.strained = 0.5;
  ResolutionTally tally;
  for (const Outputs &outputs : {right, far, strained})
    tally.add(outputs);
  std::ostringstream out;
  tally.print(out);
  EXPECT_EQ(validity_warning(right), "");
  EXPECT_NE(out.str().find("by 24 % of the largest approach: use kinematics: large"),
            std::string::npos)
      << out.str();
  EXPECT_NE(out.str().find("(the first of 2 such answers)"), std::string::npos) << out.str();
  EXPECT_NE(validity_warning(strained).find("in 50 % of the body"), std::string::npos);
}

/// Contact between training parameters that is at none of them; models whose integrals are rough by
/// choice have measured errors of that size.
TEST(ResolutionWarning, IsOfContactThatAModelDoesNotSee) {
  Outputs outputs = zones(40, 30, 1);
  outputs.quadrature_residual = 0.017;
  EXPECT_EQ(resolution_warning(outputs), "") << "no errors were measured: that is said";
  outputs.expected_error_u = 1e-14;
  outputs.expected_error_lambda = 3e-14;
  EXPECT_NE(resolution_warning(outputs).find("errors are larger than printed"), std::string::npos);
  outputs.expected_error_lambda = 2e-3;
  EXPECT_EQ(resolution_warning(outputs), "");
  outputs.expected_error_lambda = 3e-14;
  outputs.quadrature_residual = 1e-4;
  EXPECT_EQ(resolution_warning(outputs), "");
}

/// An interface that barely touches is not hidden by one that touches widely.
TEST(ResolutionWarning, IsThatOfEachInterface) {
  Outputs both, upper = zones(40, 30, 1), lower = zones(3, 3, 1e-3);
  upper.name = "upper plate";
  lower.name = "lower plate";
  add_contact(upper, both);
  EXPECT_EQ(resolution_warning(both), "");
  add_contact(lower, both);
  EXPECT_EQ(both.contact_nodes, 43);
  EXPECT_EQ(resolution_warning(both), "lower plate: " + resolution_warning(zones(3, 3, 1e-3)));
  std::ostringstream out;
  print_outputs(out, both);
  EXPECT_NE(out.str().find("\nlower plate: tangential_force 0.001 contact_nodes 3 stick_nodes 3\n"),
            std::string::npos)
      << out.str();
  lower.ends_in_contact = 1;
  Outputs at_end;
  add_contact(upper, at_end);
  add_contact(lower, at_end);
  ResolutionTally tally;
  tally.add(at_end);
  std::ostringstream told;
  tally.print(told);
  EXPECT_TRUE(told.str().starts_with("warning: lower plate: contact reaches the end of its"))
      << told.str();
}

/// Bodies that overlap between nodes without a pressure are no bodies apart.
TEST(ResolutionWarning, NamesAnOverlapWithoutPressure) {
  constexpr double none = std::numeric_limits<double>::infinity();
  const Vector gaps{{1e-3, 2e-3, 1e-3}};
  const auto overlaps = [&](double contact, const Vector &left) {
    Outputs outputs = zones(contact, 0, 0);
    set_penetration(penetration_at(left, gaps), outputs);
    return resolution_warning(outputs).find("overlap by 1e-05") != std::string::npos;
  };
  EXPECT_TRUE(overlaps(0, Vector{{-1e-5, 1e-3, none}}));
  EXPECT_FALSE(overlaps(20, Vector{{-1e-5, 1e-3, none}}));
  EXPECT_FALSE(overlaps(0, Vector{{-1e-17, 1e-3, none}}));
  EXPECT_FALSE(overlaps(0, Vector{{0, 1e-3, 1e-3}}));
}

TEST(ResolutionWarning, IsEmptyWhereThereAreEnoughNodesOrNoZone) {
  EXPECT_EQ(resolution_warning({}), "");
  EXPECT_EQ(resolution_warning(zones(9, 5, 1)), "");
  EXPECT_EQ(resolution_warning(zones(0, 0, 0)), "");
  EXPECT_EQ(resolution_warning(zones(20, 0, 0)), ""); // no friction to speak of
}

TEST(Outputs, ThatAreNotFiniteAreNoAnswer) {
  Outputs outputs = zones(9, 5, 1);
  EXPECT_NO_THROW(check_finite(outputs));
  for (const OutputColumn &column : output_columns())
    for (const double bad : {std::nan(""), 1 / 0.0}) {
      if (column.value == nullptr) continue; // of a reduced answer
      Outputs wrong = outputs;
      wrong.*column.value = bad;
      try {
        check_finite(wrong);
        FAIL() << column.name;
      } catch (const Error &error) {
        EXPECT_NE(std::string(error.what()).find(column.name), std::string::npos) << error.what();
      }
    }
}

TEST(ResolutionTally, PrintsTheFirstAndHowMany) {
  std::ostringstream none, one, two;
  ResolutionTally tally;
  tally.add(zones(9, 5, 1));
  tally.print(none);
  EXPECT_EQ(none.str(), "");
  tally.add(zones(20, 1, 1));
  tally.print(one);
  EXPECT_EQ(one.str(), "warning: " + resolution_warning(zones(20, 1, 1)) + "\n");
  tally.add(zones(5, 5, 1));
  tally.print(two);
  EXPECT_EQ(two.str(),
            "warning: " + resolution_warning(zones(20, 1, 1)) + " (the first of 2 such answers)\n");
}

TEST(ResolutionTally, CountsTheAnswersAtAnEndOfContactByThemselves) {
  Outputs at_end = zones(8, 6, 1);
  at_end.ends_in_contact = 1;
  EXPECT_NE(resolution_warning(at_end).find("contact reaches the end"), std::string::npos);
  std::ostringstream one, three;
  ResolutionTally tally;
  tally.add(at_end);
  tally.print(one);
  EXPECT_EQ(one.str(), "warning: " + resolution_warning(at_end) + "\n");
  tally.add(zones(5, 5, 1));
  at_end.ends_in_contact = 2;
  tally.add(at_end);
  tally.print(three, "samples");
  EXPECT_EQ(three.str().find("warning: 2 of 3 samples touch an end of the contact boundary"), 0U);
  EXPECT_NE(three.str().find("\nwarning: " + resolution_warning(zones(5, 5, 1)) + "\n"),
            std::string::npos);
  Outputs off = at_end;
  off.ends_in_contact = 0;
  EXPECT_EQ(resolution_warning(off), resolution_warning(zones(8, 6, 1)));
}

} // namespace
} // namespace rbvi::outputs_test
