// From a case to models side by side: one command for all steps, tables of several runs, outputs
// alone that are asked for, what is left to wait for.
#include "run.hpp"

namespace rbvi::workflow_test {
namespace {

struct Workflow : InDirectory {
  static void make(const std::string &run, const std::string &options = "") {
    output_of(rbvi(2, "offline -case case.yaml -out " + run + " " + options));
    output_of(rbvi(2, "verify -verify_stability no -out " + run));
  }
};

TEST_F(Workflow, ErrorsAndTimesAreOfTheOutputsThatAreAsked) {
  output_of(rbvi(1, "offline -case case.yaml -out run"));
  const std::string all = output_of(rbvi(1, "verify -verify_stability no -out run"));
  EXPECT_EQ(lines_with(all, "  with its outputs "), 1) << all;
  const std::string some =
      output_of(rbvi(2, "verify -verify_stability no -out run -only energy,peak_pressure"));
  EXPECT_EQ(lines_with(some, "  with those asked "), 1) << some;
  EXPECT_EQ(lines_with(some, "  normal_force "), 0) << some;
  const std::string errors = slurp("run/verify/outputs.csv");
  EXPECT_TRUE(errors.find("\nenergy,") < errors.find("\npeak_pressure,")) << errors;
  EXPECT_EQ(std::ranges::count(errors, '\n'), 3) << errors;
  const std::string one = output_of(rbvi_online("run/model.h5 --mu 0.2,0,0 --only energy"));
  EXPECT_TRUE(contains(line_with(one, "energy "), "(largest error ")) << one;
  EXPECT_EQ(lines_with(one, "peak_pressure"), 0) << one;
  const Finished wrong = shell(rbvi(1, "verify -out run -only energie"));
  EXPECT_EQ(wrong.status, 2);
  EXPECT_EQ(wrong.err, "rbvi: the model has no output 'energie': the nearest is 'energy'\n");
}

/// Of a plan what can take longest, and what all of it takes.
TEST_F(Workflow, APlanForeseesCondensationAndSelfCheck) {
  for (const std::string parameters : {"radius", "radius,poisson_ratio"}) {
    const std::string plan =
        output_of(rbvi(1, "offline -case " RBVI_CASES "/rigid_disk -arc_edges 40 -train 5 -plan "
                          "-parameters " +
                              parameters));
    for (const char *stage : {"  condensation ", "  self-check ", "  total "}) {
      const std::string line = line_with(plan, stage);
      EXPECT_TRUE(line.find(" (") < line.find(')')) << plan;
    }
  }
}

} // namespace
} // namespace rbvi::workflow_test
