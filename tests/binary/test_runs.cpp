// Whole runs: what the tools print, the same model from any ranks, resume after a kill.
#include "rbvi/core/parameters.hpp"
#include "rbvi/model/model.hpp"
#include "run.hpp"
#include "tests/catalogue.hpp"

#include <signal.h>

#include <chrono>
#include <iterator>
#include <thread>

namespace rbvi::runs_test {
namespace {

struct Runs : InDirectory {
  /// The answers of a model at a few mu: energy, forces, pressure, and the field's minimum.
  std::vector<double> answers(const std::string &run) const {
    const Finished online =
        shell(rbvi_online(run + "/model.h5 --queries random:6:3 --full --out " + run + ".csv"));
    EXPECT_EQ(online.status, 0) << online.err;
    std::istringstream lines(slurp(run + ".csv"));
    std::string line;
    std::getline(lines, line);
    const std::vector<std::string> names = split(line, ',');
    std::vector<double> values;
    while (std::getline(lines, line)) {
      const std::vector<std::string> entries = split(line, ',');
      for (std::size_t i = 0; i < names.size(); ++i)
        if (names[i] != "seconds" && names[i] != "kkt_residual" && names[i] != "status")
          values.push_back(parse_number(entries[i], names[i]));
    }
    EXPECT_GE(values.size(), 6U * 8U);
    return values;
  }

  void expect_same(const std::string &run, const std::vector<double> &expected) const {
    const std::vector<double> got = answers(run);
    ASSERT_EQ(got.size(), expected.size());
    for (std::size_t i = 0; i < got.size(); ++i)
      EXPECT_NEAR(got[i], expected[i], 1e-10 * (1 + std::abs(expected[i])))
          << run << ", value " << i;
  }

  void offline(int ranks, const std::string &arguments) const {
    const std::string out = output_of(rbvi(ranks, "offline -case case.yaml " + arguments));
    EXPECT_FALSE(contains(out, "\x1b")) << "escape sequences in a file";
  }
};

/// Expects the same training parameters chosen for the supremizers, the same primal space to 1e-8.
void expect_same_greedy(const ReducedModel &model, const ReducedModel &expected) {
  EXPECT_EQ(model.made.histories.at("pga/selected"), expected.made.histories.at("pga/selected"));
  ASSERT_EQ(model.primal_size(), expected.primal_size());
  const auto orthonormal = [](const Matrix &basis) -> Matrix {
    return Eigen::HouseholderQR<Matrix>(basis).householderQ() *
           Matrix::Identity(basis.rows(), basis.cols());
  };
  const Matrix one = orthonormal(model.fields.basis), other = orthonormal(expected.fields.basis);
  EXPECT_LE((one - other * (other.transpose() * one)).norm(), 1e-8);
}

/// Of the graded map by one and by two ranks alone.
TEST_F(Runs, TheSameModelFromAnyRanks) {
  for (const std::string map : {"similarity", "graded"}) {
    const std::string common =
        "-train grid:3,3,3 -pod_tolerance 1e-4 -cone_type mcpg -cone_tolerance 5e-2 -disc_map " +
        map + " -out " + map;
    offline(1, common + "1");
    const std::vector<double> expected = answers(map + "1");
    for (int ranks = 2; ranks <= (map == "graded" ? 2 : 4); ++ranks) {
      offline(ranks, common + std::to_string(ranks));
      expect_same(map + std::to_string(ranks), expected);
      expect_same_greedy(read_model(map + std::to_string(ranks) + "/model.h5", catalogue()),
                         read_model(map + "1/model.h5", catalogue()));
    }
    offline(2, common + "_together -sweep_ranks_per_solve 2");
    expect_same(map + "_together", expected);
    if (map == "graded") continue;
    offline(4, common + "_pairs -sweep_ranks_per_solve 2");
    expect_same(map + "_pairs", expected);
  }
}

/// The objects of SLEPc say what they are where they are asked to; a run's case file keeps the
/// question for each command.
TEST_F(Runs, EigenvaluesAndSingularValuesAreSlepcs) {
  spill("case.yaml", slurp("case.yaml") + "infsup_svd_view:\n");
  for (const std::string map : {"similarity", "graded"}) {
    const std::string out = output_of(rbvi(2, "offline -case case.yaml -pga_eps_view -pga_svd_view "
                                              "-disc_map " +
                                                  map + " -out " + map));
    EXPECT_EQ(contains(out, "EPS Object: (pga_)"), map == "graded") << "b(mu) = s(mu) b: one SVD";
    EXPECT_EQ(contains(out, "SVD Object: (pga_)"), map == "similarity");
    EXPECT_TRUE(contains(out, std::string("warning: -pga_") + (map == "graded" ? "svd" : "eps") +
                                  "_view has no effect here"))
        << out;
    EXPECT_EQ(contains(out, "type: lapack"), true);
    EXPECT_FALSE(contains(out, "(infsup_)"));
    const std::string checked = output_of(rbvi(2, "verify -out " + map));
    EXPECT_TRUE(contains(checked, "SVD Object: (infsup_)"));
    EXPECT_FALSE(contains(checked, "(pga_)"));
    const Finished refused = shell(rbvi(1, "verify -pga_eps_view -out " + map));
    EXPECT_EQ(refused.status, 2);
    EXPECT_TRUE(contains(refused.err, "supremizers are made by offline")) << refused.err;
  }
}

/// The hybrid cone of the default, with nodes that never leave contact.
TEST_F(Runs, TheSameHybridModelFromOneAndTwoRanks) {
  for (const std::string map : {"similarity", "graded"}) {
    const std::string common = "-cone_ring 0 -load -60 -disc_map " + map + " -out " + map;
    offline(1, common + "1");
    offline(2, common + "2");
    expect_same(map + "2", answers(map + "1"));
    const Finished model = shell(rbvi_online(map + "1/model.h5"));
    EXPECT_EQ(lines_with(model.out, "functions of either sign"), 1) << model.out;
    const Finished inspected = shell(rbvi(2, "inspect " + map + "1/model.h5"));
    EXPECT_EQ(lines_with(inspected.out, "functions of either sign"), 1) << inspected.out;
  }
}

/// On the graded map one of them: what an enrichment does knows nothing of maps.
TEST_F(Runs, EveryEnrichmentIsReducedAndVerified) {
  struct Way {
    std::string options, row;
  };
  for (const std::string map : {"similarity", "graded"})
    for (const Way &way :
         {Way{"decorrelated", "modes alone"}, Way{"online", "supremizers made online"},
          Way{"offline", "supremizers made offline"},
          Way{"offline -pga_product energy", "supremizers made offline"}}) {
      if (map == "graded" && way.options != "offline") continue;
      SCOPED_TRACE(map + " " + way.options);
      fs::remove_all("run");
      offline(2, "-cone_ring 0 -load -60 -disc_map " + map + " -out run -pga_enrichment " +
                     way.options);
      output_of(rbvi(2, "verify -out run"));
      const std::string summary = slurp("run/verify/summary.csv");
      EXPECT_TRUE(summary.starts_with("model,N,S,R,free_modes,u_mean,")) << summary;
      const std::vector<std::string> row = split(line_with(summary, way.row), ',');
      ASSERT_EQ(row.size(), 17U);
      EXPECT_EQ(row[2] == "0", way.options == "decorrelated") << summary;
      EXPECT_GT(parse_number(row[4], "free_modes"), 0) << summary;
      EXPECT_EQ(row[15] == "0", fs::exists("run/verify/worst_pressure.csv")) << summary;
      for (const char *table : {"errors", "samples", "infsup", "stability", "mesh_quality"})
        EXPECT_TRUE(fs::exists("run/verify/" + std::string(table) + ".csv")) << table;
      EXPECT_FALSE(fs::exists("run/verify/cones.csv"));
      EXPECT_EQ(contains(shell(rbvi_online("run/model.h5")).out, "made online"),
                way.options == "online");
    }
}

/// A number in the only row of a table.
double in_table(const std::string &path, const std::string &name) {
  std::istringstream lines(slurp(path));
  std::string names, row;
  std::getline(lines, names);
  std::getline(lines, row);
  const std::vector<std::string> columns = split(names, ',');
  const auto at = std::ranges::find(columns, name) - columns.begin();
  return parse_number(split(row, ',').at(at), name);
}

/// A model of hundreds of functions: terms of A that differ on few of them, displacements kept
/// where contact moves; and one with the hat functions of the coarser mesh, which is smaller.
TEST_F(Runs, ManyHatFunctionsAndThoseOfACoarserMesh) {
  spill("case.yaml",
        "case: " RBVI_CASES "/membrane_obstacle\nmesh_refine: 1\ntrain: random:12:1\n");
  offline(2, "-out fine");
  offline(2, "-cone_level 1 -out coarse");
  const ReducedModel fine = read_model("fine/model.h5", catalogue()),
                     coarse = read_model("coarse/model.h5", catalogue());
  EXPECT_GT(fine.body.a_change.rank(), 0);
  EXPECT_LT(fine.body.a_change.rank(), fine.primal_size() / 3);
  EXPECT_FALSE(fine.contact.trace_dofs.empty());
  EXPECT_EQ(coarse.made.settings.at("cone_level"), "1");
  EXPECT_LT(2 * coarse.contact.generators, fine.contact.generators);
  output_of(rbvi(1, "solve -case case.yaml -mu 0.19,0.01,-0.02 -csv truth.csv"));
  for (const std::string run : {"fine", "coarse"}) {
    EXPECT_TRUE(read_model(run + "/model.h5", catalogue()).made.self_check.clean());
    output_of(rbvi_online(run + "/model.h5 --mu 0.19,0.01,-0.02 --out " + run + ".csv"));
    for (const char *output : {"energy", "normal_force"}) {
      const double truth = in_table("truth.csv", output);
      EXPECT_NEAR(in_table(run + ".csv", output), truth, 2e-3 * std::abs(truth)) << run << output;
    }
  }
}

/// As many functions as the edge moves over nodes, no mode: a model that can be written and read,
/// and whose answers are refused.
TEST_F(Runs, AHybridConeWithoutModesIsAModel) {
  const std::string common = "offline -case case.yaml -cone_ring 0 -load -60 -out run ";
  const Finished refused = shell(rbvi(1, common + "-cone_max_size 1"));
  const std::string words = "moves over ";
  ASSERT_TRUE(contains(refused.err, words)) << refused.err;
  const int moving = std::stoi(refused.err.substr(refused.err.find(words) + words.size()));
  const Finished run = shell(rbvi(1, common + "-cone_max_size " + std::to_string(moving)));
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_TRUE(contains(run.out, "R = " + std::to_string(moving) + " functions >= 0 (hybrid)"))
      << run.out;
  const Finished model = shell(rbvi(1, "inspect run/model.h5"));
  EXPECT_EQ(model.status, 0) << model.err;
  EXPECT_EQ(lines_with(model.out, "functions of either sign"), 0) << model.out;
  const Finished answer = shell(rbvi_online("run/model.h5 --mu 0.2,0,0"));
  EXPECT_EQ(answer.status, 1);
  EXPECT_TRUE(contains(answer.err, "the pressure is negative")) << answer.err;
}

std::size_t count_samples(const std::string &run) {
  std::size_t count = 0;
  for (const auto &entry : fs::directory_iterator(run + "/samples"))
    count += entry.path().extension() == ".h5" ? 1 : 0;
  return count;
}

enum class Victim { mpirun_and_ranks, one_rank };

std::vector<pid_t> children_of(pid_t parent) {
  const std::string id = std::to_string(parent);
  std::istringstream text(slurp("/proc/" + id + "/task/" + id + "/children"));
  return {std::istream_iterator<pid_t>(text), {}};
}

/// Starts `command`, which sweeps into killed/, and kills it as soon as 10 samples are there.
/// False if it was done before.
bool kill_in_the_sweep(const std::string &command, Victim victim) {
  const pid_t child = fork();
  if (child == 0) {
    execl("/bin/sh", "sh", "-c", ("exec " + command + " >killed.txt 2>&1").c_str(), nullptr);
    _exit(127);
  }
  int status = 0;
  while (!fs::exists("killed/samples") || count_samples("killed") < 10) {
    if (waitpid(child, &status, WNOHANG) == child) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const std::vector<pid_t> ranks = children_of(child);
  if (victim == Victim::mpirun_and_ranks) kill(child, SIGKILL);
  for (const pid_t rank : ranks)
    if (victim == Victim::mpirun_and_ranks || rank == ranks.back()) kill(rank, SIGKILL);
  waitpid(child, &status, 0);
  return !ranks.empty();
}

TEST_F(Runs, ResumesAfterAKill) {
  const std::string sweep = "offline -case case.yaml -train grid:4,4,4 "
                            "-pod_tolerance 1e-3 -cone_type mcpg -cone_tolerance 1e-1 -out ";
  ASSERT_EQ(shell(rbvi(2, sweep + "whole")).status, 0);
  const std::vector<double> expected = answers("whole");
  for (const Victim victim : {Victim::mpirun_and_ranks, Victim::one_rank}) {
    fs::remove_all("killed");
    ASSERT_TRUE(kill_in_the_sweep(rbvi(2, sweep + "killed"), victim)) << slurp("killed.txt");
    EXPECT_FALSE(fs::exists("killed/model.h5"));
    const std::size_t present = count_samples("killed");
    ASSERT_LT(present, 64U);
    const Finished resumed = shell(rbvi(2, sweep + "killed"));
    EXPECT_EQ(resumed.status, 0) << resumed.err;
    EXPECT_TRUE(contains(resumed.out, "; " + std::to_string(present) + " reused")) << resumed.out;
    EXPECT_TRUE(contains(resumed.out, std::to_string(64 - present) + " solved")) << resumed.out;
    expect_same("killed", expected);
  }
}

TEST_F(Runs, AFailingSampleIsNamedAndTheOthersServe) {
  const std::string uzawa = "offline -case case.yaml -hf_method uzawa -uzawa_tolerance 1e-10 ";
  const std::string arguments = uzawa + "-uzawa_max_iterations 5600 -sweep_max_failures 0.5 "
                                        "-out run"; // 4892 to 6086 needed
  for (const int ranks : {1, 2}) {
    const Finished run = shell(rbvi(ranks, arguments));
    EXPECT_EQ(run.status, 1) << run.err;
    EXPECT_TRUE(contains(run.out, "failed at radius=0.16 center_x=-0.05 center_y=0.05: "))
        << run.out;
    EXPECT_TRUE(contains(run.out, "no convergence in -uzawa_max_iterations")) << run.out;
    EXPECT_TRUE(contains(run.out, "2 failed")) << run.out;
    EXPECT_TRUE(fs::exists("run/model.h5"));
  }
  EXPECT_EQ(count_samples("run"), 6U);
  const Finished none = shell(rbvi(2, uzawa + "-uzawa_max_iterations 10 -out none"));
  EXPECT_EQ(none.status, 1);
  EXPECT_EQ(lines_with(none.err, "rbvi: no sample succeeded"), 1) << none.err;
  EXPECT_FALSE(fs::exists("none/model.h5"));
}

TEST_F(Runs, PlanAndEndAreOneTable) {
  const Finished plan = shell(rbvi(2, "offline -case case.yaml -load 0 -plan"));
  EXPECT_EQ(plan.status, 0);
  EXPECT_TRUE(line_with(plan.out, "  load vector").ends_with(" skipped: the scene has no load"));
  EXPECT_EQ(lines_with(plan.out, "The most memory that a stage takes is about "), 1) << plan.out;
  EXPECT_TRUE(contains(plan.out, "8 high-fidelity solves by 2 groups of 1 rank")) << plan.out;
  EXPECT_TRUE(contains(plan.out, "Solves are by 2 groups of 1 rank: 8 samples of about "))
      << plan.out;
  EXPECT_TRUE(contains(line_with(plan.out, "  total "), "(")) << plan.out;
  const Finished run = shell(rbvi(2, "offline -case case.yaml -out run"));
  for (const char *stage :
       {"mesh", "snapshots", "interpolation", "POD", "cone", "PGA", "projection"})
    EXPECT_EQ(lines_with(run.out, std::string("  ") + stage + " "), 2) << stage << run.out;
  EXPECT_TRUE(contains(run.out, "skipped: B(mu) = s(mu) B")) << run.out;
  EXPECT_TRUE(contains(run.out, "8 of 8 samples, 2 groups, ")) << run.out;
  const Finished again = shell(rbvi(1, "offline -out run"));
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_TRUE(contains(again.out, "skipped: all 8 were there")) << again.out;
  EXPECT_TRUE(contains(again.out, "skipped: the one group holds all ranks")) << again.out;
}

TEST_F(Runs, ARunKeepsItsOptions) {
  EXPECT_EQ(
      shell(rbvi(1, "offline -case case.yaml -load -20 --hf_pc_type lu "
                    "-hf_pc_factor_mat_solver_type mumps -hf_mat_mumps_icntl_14 50 -out 'a run'"))
          .status,
      0);
  fs::remove("case.yaml");
  const Finished verify = shell(rbvi(2, "verify -out 'a run'"));
  EXPECT_EQ(verify.status, 0) << verify.err;
  EXPECT_TRUE(contains(slurp("a run/case.yaml"), "load: -20\n"));
  EXPECT_TRUE(contains(slurp("a run/case.yaml"), "hf_mat_mumps_icntl_14: 50\n"));
  const Finished model = shell(rbvi_online("'a run/model.h5'"));
  EXPECT_TRUE(contains(model.out, "load -20")) << model.out;
}

TEST_F(Runs, FixedParameters) {
  const std::string run = "offline -case case.yaml -train grid:4 -out ";
  EXPECT_EQ(shell(rbvi(1, run + "a -center_x 0.01 -center_y 0")).status, 0);
  EXPECT_EQ(shell(rbvi(1, run + "b -parameters radius")).status, 0);
  EXPECT_TRUE(contains(shell(rbvi_online("a/model.h5")).out, "0.01 (fixed)"));
  EXPECT_TRUE(contains(shell(rbvi_online("b/model.h5")).out, "0 (fixed)"));
  EXPECT_EQ(shell(rbvi_online("a/model.h5 --mu 0.2")).status, 0);
}

TEST_F(Runs, HelpVersionAndListWithOneAndTwoDashes) {
  for (const int ranks : {1, 2})
    for (const std::string dashes : {"-", "--"}) {
      if (ranks == 2 && dashes == "-") continue;
      const Finished help = shell(rbvi(ranks, dashes + "help"));
      EXPECT_EQ(help.status, 0);
      EXPECT_EQ(lines_with(help.out, "rbvi COMMAND"), 1) << help.out;
      EXPECT_TRUE(contains(help.out, "-sweep_ranks_per_solve"));
      const Finished version = shell(rbvi(ranks, dashes + "version"));
      EXPECT_EQ(version.status, 0);
      EXPECT_EQ(lines_with(version.out, "rbvi " RBVI_VERSION), 1) << version.out;
      const Finished solve = shell(rbvi(ranks, "solve " + dashes + "case case.yaml " + dashes +
                                                   "mu 0.2,0,0 " + dashes + "csv u.csv"));
      EXPECT_EQ(solve.status, 0) << solve.err;
      EXPECT_EQ(solve.err, "");
      EXPECT_TRUE(contains(slurp("u.csv"), "radius,center_x,center_y,energy"));
    }
  const Finished list = shell(rbvi(2, "list " RBVI_CASES));
  EXPECT_EQ(list.status, 0);
  EXPECT_EQ(lines_with(list.out, "membrane_obstacle"), 1);
  EXPECT_EQ(shell("sh -c '" + rbvi(1, "list " RBVI_CASES) + " > /dev/full'").status, 1);
}

TEST_F(Runs, ACaseMayBeNamedByItsFolder) {
  const std::string scene =
      " -case " RBVI_CASES "/two_disks -arc_edges 40 -train grid:5 -valid grid:2 ";
  EXPECT_TRUE(contains(output_of(rbvi(2, "offline -plan" + scene)), "snapshots"));
  EXPECT_TRUE(contains(output_of(rbvi(2, "solve -mu 1" + scene)), "kkt_residual"));
  for (const char *command : {"offline", "verify", "bench"})
    EXPECT_TRUE(contains(output_of(rbvi(2, command + scene + "-out run")), "wrote run/"));
}

/// Options of PETSc itself: what is left over is what nothing asked for, and memory is whole.
TEST_F(Runs, OptionsOfPetscItself) {
  const std::string solve = "solve -case case.yaml -mu 0.2,0,0 -hf_pc_type lu ";
  for (const int ranks : {1, 2}) {
    const std::string left = output_of(rbvi(ranks, solve + "-options_left"));
    EXPECT_TRUE(contains(left, "There are no unused options.")) << left;
    for (const char *option : {"-malloc_debug", "-malloc_dump", "-options_view", "-log_view"})
      EXPECT_TRUE(contains(output_of(rbvi(ranks, solve + option)), "kkt_residual")) << option;
  }
}

/// Iterative solvers are as good as the direct ones unless an option says otherwise.
TEST_F(Runs, IterativeSolversOfPetscGiveTheSame) {
  const std::string solve = "solve -case case.yaml -mu 0.2,0,0 ";
  const double energy = value_of(output_of(rbvi(1, solve)), "energy");
  for (const char *options : {"-hf_ksp_type cg", "-hf_ksp_type cg -hf_pc_type jacobi",
                              "-hf_ksp_type cg -hf_pc_type icc -hf_ksp_max_it 500"})
    EXPECT_NEAR(value_of(output_of(rbvi(1, solve + options)), "energy"), energy, 1e-9) << options;
  const std::string vi = solve + "-lumped yes -hf_method vi ";
  const double bounded = value_of(output_of(rbvi(1, vi)), "energy");
  EXPECT_NEAR(value_of(output_of(rbvi(1, vi + "-vi_ksp_type cg -vi_pc_type icc")), "energy"),
              bounded, 1e-9);
  // The systems of vi differ in size from step to step.
  expect_refused({vi, "multigrid does not follow the systems of vi"},
                 shell(rbvi(1, vi + "-vi_ksp_type cg -vi_pc_type gamg")), 1);
}

/// Multigrid is as good as the limit on KKT residuals asks for; where it is told not to be, the
/// failure names that.
TEST_F(Runs, MultigridOnTheDefaultTolerance) {
  const std::string solve = "solve -case " RBVI_CASES "/rigid_disk -arc_edges 40 -mu 1 "
                            "-hf_ksp_type cg -hf_pc_type gamg ";
  EXPECT_LE(value_of(output_of(rbvi(1, solve)), "kkt_residual"), 1e-10);
  // Two steps of refinement answer at 1e-7.
  EXPECT_LE(value_of(output_of(rbvi(1, solve + "-hf_ksp_rtol 1e-7")), "kkt_residual"), 1e-10);
  expect_refused({solve, "lower -hf_ksp_rtol", 1}, shell(rbvi(1, solve + "-hf_ksp_rtol 1e-3")), 1);
}

/// One half is a million times as stiff: steps that suit the other half are small long before the
/// laws hold.
TEST_F(Runs, UzawaSmallStepsAreNoAnswer) {
  const std::string solve =
      "solve -case " RBVI_CASES "/patch -mu 0.05 -hf_method uzawa -uzawa_tolerance 1e-3 "
      "-set 'materials.rubber.E=young * (x > 0.5 ? 1e6 : 1)'";
  for (const int ranks : {1, 2})
    expect_refused({solve, "the KKT residual is 0.49", 1}, shell(rbvi(ranks, solve)), ranks);
}

/// A reader that has seen enough ends the command without a word. (Under mpirun the reader is
/// mpirun's, whose own words at that are not ours.)
TEST_F(Runs, AClosedStandardOutputEndsQuietly) {
  const std::string closed = " | (exec <&-; sleep 1); exit ${PIPESTATUS[0]}'";
  for (const std::string &command :
       {rbvi(1, "-help"), rbvi(1, "list " RBVI_CASES), rbvi(1, "solve -case case.yaml -mu 0.2,0,0"),
        rbvi_online("--help")}) {
    const Finished run = shell("bash -c '" + command + closed);
    EXPECT_TRUE(run.status == 0 || run.status == 141) << command << " " << run.status;
    EXPECT_EQ(run.err, "") << command;
  }
}

/// One rank fails while the others wait for it: one line, its status, and no hang.
TEST_F(Runs, ALostRankEndsAll) {
  const Finished run = shell(RBVI_MPIRUN " -n 3 " RBVI_TEST_TOOL " --gtest_also_run_disabled_tests "
                                         "--gtest_filter=*ARankLeavesTheOthersWaiting");
  EXPECT_EQ(run.status, 1) << run.err;
  EXPECT_EQ(lines_with(run.err, "rbvi: this rank is lost"), 1) << run.err;
  EXPECT_FALSE(contains(run.out + run.err, "should have been ended"));
}

} // namespace
} // namespace rbvi::runs_test
