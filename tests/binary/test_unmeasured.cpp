// What is known of the errors of a model, and said: nothing before rbvi verify; then those at so
// many parameters.
#include "run.hpp"

namespace rbvi::unmeasured_test {
namespace {

struct Unmeasured : InDirectory {
  void SetUp() override {
    InDirectory::SetUp();
    spill("disk.yaml",
          "case: " RBVI_CASES "/rigid_disk\narc_edges: 30\nfriction: none\nnormal: rigid\n"
          "parameters: radius,indentation\nvalid: random:3:1\n");
  }
};

/// One sample, or five equal ones, are met to every tolerance, and the reduced problem is solved to
/// round-off: what is wrong is that bodies penetrate.
TEST_F(Unmeasured, AModelOfOneSampleSaysThatNobodyKnowsItsErrors) {
  const std::string header = "radius,indentation\n", sample = "0.8,0.02\n";
  spill("one.csv", header + sample);
  spill("five.csv", header + sample + sample + sample + sample + sample);
  for (const std::string set : {"one", "five"}) {
    const std::string run = "run_" + set;
    const std::string out =
        output_of(rbvi(1, "offline -case disk.yaml -train " + set + ".csv -out " + run));
    EXPECT_TRUE(contains(out, "bodies penetrate")) << out;
    EXPECT_TRUE(contains(out, "Its errors are not measured: rbvi verify -out " + run)) << out;
    EXPECT_TRUE(contains(out, "warning: 1 different sample for 2 free parameters")) << out;
    const std::string model = run + "/model.h5";
    EXPECT_TRUE(contains(line_with(output_of(rbvi(1, "inspect " + model)), "expected error"),
                         "not measured"));
    EXPECT_TRUE(contains(output_of(rbvi_online(model + " --mu 0.8,0.02")), "not measured"));
    EXPECT_TRUE(contains(shell(rbvi_online(model + " --queries grid:1,2")).err, "not measured"));
  }
}

TEST_F(Unmeasured, AParameterThatNoSampleVariesIsTold) {
  spill("line.csv", "radius,indentation\n0.8,0.02\n0.8,0.03\n0.8,0.04\n");
  const std::string out =
      output_of(rbvi(1, "offline -case disk.yaml -train line.csv -out run_line"));
  EXPECT_TRUE(contains(out, "warning: all samples have one radius")) << out;
  EXPECT_FALSE(contains(out, "one indentation")) << out;
}

TEST_F(Unmeasured, VerifyMeasuresTheBoundaryOfTheBoxAsWell) {
  output_of(rbvi(2, "offline -case disk.yaml -train grid:4,4 -out run"));
  const std::string out = verified();
  EXPECT_TRUE(contains(out, "Relative errors over 3 validation mu")) << out;
  EXPECT_TRUE(contains(out, "Relative errors at 8 corners and centres of faces")) << out;
  EXPECT_TRUE(contains(out, "largest over all 11")) << out;
  EXPECT_EQ(lines_with(slurp("run/verify/errors.csv"), ""), 1 + 3);
  EXPECT_EQ(lines_with(slurp("run/verify/errors_at_boundary.csv"), ""), 1 + 8);
  const std::string answer = output_of(rbvi_online("run/model.h5 --mu 1.2999,0.0101"));
  EXPECT_TRUE(contains(line_with(answer, "expected error"), "over 11 parameters")) << answer;
  EXPECT_FALSE(contains(answer, "nearer to a corner")) << answer;
  // All of them are validated by name: nothing is left beside them.
  output_of(rbvi(2, "verify -out run -valid grid:3,3"));
  EXPECT_FALSE(fs::exists("run/verify/errors_at_boundary.csv"));
  EXPECT_TRUE(contains(output_of(rbvi(1, "inspect run/model.h5")), "over 9 parameters"));
}

} // namespace
} // namespace rbvi::unmeasured_test
