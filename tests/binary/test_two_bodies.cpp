// Two bodies with both tools from outside: a whole run on 2 ranks, what it skips, and bad input.
#include "run.hpp"

namespace rbvi::two_bodies_test {
namespace {

struct TwoBodies : InDirectory {
  void SetUp() override {
    InDirectory::SetUp();
    spill("disks.yaml", "case: " RBVI_CASES "/two_disks\n"
                        "train: grid:7\n"
                        "valid: random:3:1\n"
                        "multiplier_reduction: cone\n"
                        "pod_tolerance: 1e-4\n");
  }
};

TEST_F(TwoBodies, AreReducedVerifiedAndAsked) {
  const std::string offline = output_of(rbvi(2, "offline -case disks.yaml -out run"));
  EXPECT_TRUE(contains(offline, "7 of 7 samples")) << offline;
  EXPECT_TRUE(contains(offline, "7 solved by 2 groups of 1 rank")) << offline;
  const std::string verify = verified();
  EXPECT_TRUE(contains(verify, "over 3 validation mu")) << verify;
  EXPECT_TRUE(contains(verify, " 0 exceptions")) << verify;

  const std::string online = output_of(rbvi_online("run/model.h5 --mu 0.85 --vtu u.vtu"));
  const std::string solve = output_of(rbvi(2, "solve -case disks.yaml -mu 0.85 -vtu full.vtu"));
  for (const char *name : {"energy", "normal_force", "peak_pressure"}) {
    const double truth = value_of(solve, name);
    EXPECT_NEAR(value_of(online, name), truth, 0.02 * truth) << name;
  }
  EXPECT_LE(value_of(online, "expected_error_u"), 1e-2);
  for (const char *file : {"u.vtu", "full.vtu"})
    EXPECT_TRUE(contains(slurp(file), "NumberOfPoints=\"6142\" NumberOfCells=\"2880\"")) << file;
  for (const char *file : {"u_contact.vtu", "full_contact.vtu"})
    expect_fields(file, {"pressure", "gap", "u"});

  const Finished model = shell(rbvi_online("run/model.h5"));
  EXPECT_TRUE(contains(model.out, "two_disks")) << model.out;
  EXPECT_TRUE(contains(model.out, "radius")) << model.out;
  const Finished inspected = shell(rbvi(2, "inspect run/model.h5"));
  EXPECT_EQ(inspected.status, 0) << inspected.err;
}

/// By default the law of contact is kept at every node: exact from a few radii on.
TEST_F(TwoBodies, KeepTheirNodesUnlessAskedOtherwise) {
  const std::string offline =
      output_of(rbvi(2, "offline -case " RBVI_CASES
                        "/two_disks -arc_edges 40 -train grid:5 -valid random:3:1 -out run"));
  EXPECT_TRUE(contains(offline, "\nwrote run/model.h5, run/model.fields.h5,")) << offline;
  const std::string verify = verified();
  EXPECT_TRUE(contains(verify, "Inf-sup constants: none, -multiplier_reduction condensed"))
      << verify;
  const std::string bare = output_of(rbvi_online("run/model.h5 --mu 0.85"));
  EXPECT_LE(value_of(bare, "expected_error_lambda"), 1e-9);
  EXPECT_LE(value_of(bare, "expected_error_u"), 1e-6);

  fs::rename("run/model.fields.h5", "away.h5");
  EXPECT_EQ(value_of(output_of(rbvi_online("run/model.h5 --mu 0.85")), "peak_pressure"),
            value_of(bare, "peak_pressure"));
  const Finished picture = shell(rbvi_online("run/model.h5 --mu 0.85 --vtu u.vtu"));
  EXPECT_EQ(picture.status, 2);
  EXPECT_TRUE(contains(picture.err, "run/model.fields.h5 is missing")) << picture.err;
  EXPECT_EQ(shell(rbvi(1, "verify -out run")).status, 2);
  fs::rename("away.h5", "run/model.fields.h5");
  EXPECT_EQ(shell(rbvi_online("run/model.h5 --mu 0.85 --vtu u.vtu")).status, 0);
}

/// The bodies at rest, where the iteration of a query begins, open at nodes where its answer does
/// not: no wider ring of nodes is needed. Near radius 1.188 they do not face each other after its
/// first step, and do so halfway.
TEST_F(TwoBodies, AQueryIsJudgedByItsAnswerAlone) {
  const std::string offline = output_of(
      rbvi(2, "offline -case " RBVI_CASES "/two_disks -kinematics large -multiplier_reduction cone "
              "-radius 1,3 -indentation 0.2 -arc_edges 40 -train grid:15 -out run"));
  EXPECT_TRUE(contains(offline, "202 answers to 202 queries")) << offline;
  EXPECT_FALSE(contains(offline, "widened")) << offline;
  const Finished queries =
      shell(rbvi_online("run/model.h5 --queries grid:2000 --out answers.csv"));
  EXPECT_EQ(queries.status, 0) << queries.err;
}

TEST_F(TwoBodies, ThePlanSaysWhatIsSkipped) {
  const Finished plan = shell(rbvi(2, "offline -case disks.yaml -plan"));
  EXPECT_EQ(plan.status, 0) << plan.err;
  EXPECT_FALSE(fs::exists("run"));
  const auto expect_line = [&](const char *stage, const char *part) {
    const std::string line = line_with(plan.out, "  " + std::string(stage) + " ");
    EXPECT_TRUE(contains(line, part)) << line;
  };
  expect_line("mesh", "two_graded_quarter_discs");
  expect_line("factorisations", "one for the sweep");
  expect_line("interpolation", "skipped: A does not depend on mu");
  expect_line("load vector", "skipped: the scene has no load");
  expect_line("tangential multipliers", "skipped: the scene has no friction");
  expect_line("supremizers at all mu", "B depends on mu: part of PGA");
  EXPECT_TRUE(contains(line_with(plan.out, "  total "), "(")) << plan.out;
}

TEST_F(TwoBodies, ThePatchTestIsReducedToOneModeAndOneGenerator) {
  spill("patch.yaml", "case: " RBVI_CASES "/patch\ntrain: grid:5\nvalid: random:5:1\n");
  const Finished offline = shell(rbvi(2, "offline -case patch.yaml -out run"));
  ASSERT_EQ(offline.status, 0) << offline.err;
  EXPECT_TRUE(contains(offline.out, "N = 1 mode,")) << offline.out;
  const Finished verify = shell(rbvi(2, "verify -out run"));
  EXPECT_EQ(verify.status, 0) << verify.err;
  const Finished online = shell(rbvi_online("run/model.h5 --mu 0.04"));
  ASSERT_EQ(online.status, 0) << online.err;
  EXPECT_NEAR(value_of(online.out, "normal_force"), 15 * 0.65 / (1.35 * 0.3) * 0.04, 1e-9);
}

TEST_F(TwoBodies, WithoutContactEverywhereThereIsNoModel) {
  const Finished run =
      shell(rbvi(2, "offline -case disks.yaml -initial_gap 0.5 -train grid:2 -out run"));
  EXPECT_EQ(run.status, 1) << run.err;
  EXPECT_EQ(lines_with(run.err, "rbvi: "), 1) << run.err;
  EXPECT_TRUE(contains(run.err, "there is no contact at any training mu")) << run.err;
  EXPECT_FALSE(fs::exists("run/model.h5"));
}

TEST_F(TwoBodies, BadInputIsRefused) {
  const std::string disks = "offline -case disks.yaml -out run ";
  expect_all_refused(
      {{disks + "-multiplier p2", "use one of p0, p1"},
       {disks + "-integration exact", "use one of intersection, direct"},
       {disks + "-young -1", "option young is -1: its range of validity"},
       {disks + "-young 0", "option young is 0: its range of validity"},
       {disks + "-poisson_ratio 0.5", "option poisson_ratio is 0.5: its range of validity"},
       {disks + "-poisson_ratio -1", "option poisson_ratio is -1: its range of validity"},
       {disks + "-indentation 5", "option indentation is 5: its range of validity is [0, 0.2]"},
       {disks + "-radius 0,1.4", "is 0: its range of validity is [0.45, 10]"},
       {disks + "-radius 0.7,1e300", "is 1e+300: its range of validity is [0.45, 10]"},
       {disks + "-indentation deep", "'deep': not a number"},
       {disks + "-load -25", "unknown option -load"},
       {"solve -case disks.yaml -mu 1.5", "radius = 1.5 is outside [0.7, 1.3]"},
       {disks + "-hf_method vi", "needs a bound at each node"},
       {"offline -case " RBVI_CASES "/two_disks -cone_type mcpg -out run",
        "condensed, the default here, keeps every node: add -multiplier_reduction cone"},
       {"solve -case disks.yaml -mesh coarse.msh -mu 1", "no physical region 'upper'"}});
}

/// The box of the radius is the user's.
TEST_F(TwoBodies, TheBoxCanBeWider) {
  const Finished run =
      shell(rbvi(1, "offline -case disks.yaml -radius 0.5,1.4 -train grid:3 -out run"));
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(shell(rbvi_online("run/model.h5 --mu 0.55")).status, 0);
  const Finished outside = shell(rbvi_online("run/model.h5 --mu 0.45"));
  EXPECT_EQ(outside.status, 2);
  EXPECT_TRUE(contains(outside.err, "outside [0.5, 1.4]")) << outside.err;
}

} // namespace
} // namespace rbvi::two_bodies_test
