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

TEST_F(Workflow, RunsThatWereVerifiedStandSideBySide) {
  make("one");
  make("two", "-pod_tolerance 1e-2 -cone_tolerance 1e-1");
  output_of(rbvi(1, "offline -case case.yaml -out three"));
  const std::string out = output_of(rbvi(1, "compare one two/model.h5 -csv runs.csv"));
  EXPECT_TRUE(contains(out, "wrote runs.csv")) << out;
  for (const char *row :
       {"scene ", "functions of u ", "of the multipliers ", "error of u ", "error of energy ",
        "error of peak_pressure ", "ms/query ", "offline s ", "model MB "})
    EXPECT_EQ(lines_with(out, row), 1) << row << "\n" << out;
  EXPECT_FALSE(contains(out, "kkt_residual"));
  std::istringstream table(slurp("runs.csv"));
  std::string header, first, second, rest;
  std::getline(table, header);
  std::getline(table, first);
  std::getline(table, second);
  EXPECT_FALSE(std::getline(table, rest));
  const std::vector<std::string> names = split(header, ','), one = split(first, ','),
                                 two = split(second, ',');
  ASSERT_EQ(one.size(), names.size());
  ASSERT_EQ(two.size(), names.size());
  EXPECT_EQ(one.front(), "\"one\"");
  EXPECT_EQ(two.front(), "\"two/model.h5\"");
  const auto number = [&](const std::vector<std::string> &row, const std::string &name) {
    return parse_number(row.at(std::ranges::find(names, name) - names.begin()), name);
  };
  EXPECT_GT(number(one, "functions of u"), number(two, "functions of u"));
  EXPECT_LT(number(one, "error of u"), number(two, "error of u"));
  EXPECT_GT(number(two, "ms/query"), 0);
  EXPECT_EQ(number(two, "training samples"), 8);
  const Finished unverified = shell(rbvi(1, "compare one three"));
  EXPECT_EQ(unverified.status, 2);
  EXPECT_EQ(unverified.err,
            "rbvi: three was not verified: rbvi verify -out three measures its errors\n");
  EXPECT_TRUE(contains(shell(rbvi(2, "compare one four")).err, "rbvi: four "));
  EXPECT_TRUE(contains(shell(rbvi(1, "compare one two -csv one/model.h5")).err, "overwrite"));
  EXPECT_EQ(shell(RBVI_FIGURES " one two").status, 0);
  EXPECT_TRUE(fs::exists("figures/compare.pdf"));
  const Finished missing = shell(RBVI_FIGURES " one three");
  EXPECT_EQ(missing.status, 1);
  EXPECT_TRUE(contains(missing.err, "run rbvi verify -out three first")) << missing.err;
}

TEST_F(Workflow, OneCommandTakesAllSteps) {
  const std::string out = output_of(rbvi(2, "run case.yaml -verify_stability no"));
  for (const char *step : {"check ", "offline ", "verify ", "figures "})
    EXPECT_EQ(lines_with(out, step), 1) << out;
  EXPECT_EQ(std::ranges::count(out, '\n'), 6) << out;
  EXPECT_TRUE(contains(out, "; largest errors ")) << out;
  const std::string run = "run/membrane_obstacle";
  EXPECT_TRUE(fs::exists(run + "/figures/errors.png"));
  EXPECT_TRUE(contains(slurp(run + "/run.log"), "what was warned of stands"));
  EXPECT_TRUE(contains(slurp(run + "/run.log"), "Relative errors over 3 validation mu"));
  const std::string again = output_of(rbvi(1, "verify -verify_stability yes -out " + run));
  EXPECT_TRUE(contains(again, "Inf-sup constants"));
}

TEST_F(Workflow, TheFirstStepThatFailsIsTheLast) {
  const Finished failed = shell(rbvi(1, "run case.yaml -out here -hf_method uzawa "
                                        "-uzawa_max_iterations 10"));
  EXPECT_EQ(failed.status, 1) << failed.err;
  EXPECT_TRUE(contains(line_with(failed.out, "check "), "failed")) << failed.out;
  EXPECT_EQ(lines_with(failed.out, "offline "), 0);
  EXPECT_EQ(lines_with(failed.err, "rbvi: "), 1) << failed.err;
  EXPECT_FALSE(fs::exists("here"));
  expect_all_refused({{"run case.yaml -plan", "-plan has no effect on rbvi run"},
                      {"run case.yaml -mu 0.2,0,0", "it is for rbvi solve"},
                      {"run case.yaml -train grid:2", "grid:2 has 1 count"}});
}

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

TEST_F(Workflow, OutputsOnRefinedMeshes) {
  spill("rod.yaml", "case: " RBVI_CASES "/known/hanging_bar\n");
  const std::string out = output_of(rbvi(2, "bench -case rod.yaml -convergence 0,1,2 -out run"));
  EXPECT_GT(lines_with(out, "stopped "), 2) << out;
  std::istringstream table(slurp("run/bench/convergence.csv"));
  std::string line;
  std::getline(table, line);
  EXPECT_EQ(line, "test,output,refine_0,refine_1,refine_2,order_2,richardson,expected,off_by");
  int expected = 0;
  while (std::getline(table, line))
    expected += line.ends_with(",") ? 0 : 1;
  EXPECT_GT(expected, 0) << out;
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
