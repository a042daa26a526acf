// Where options come from, and what becomes of those without effect.
#include "run.hpp"

namespace rbvi::options_test {
namespace {

struct Options : InDirectory {
  /// What a solve prints.
  static std::string solved(const std::string &environment, const std::string &arguments = "") {
    return output_of("env HOME=" + fs::absolute("home").string() + " " + environment + " " +
                     rbvi(1, "solve -case case.yaml -mu 0.2,0,0 " + arguments));
  }
  static double energy(const std::string &out) { return value_of(out, "energy"); }
  void SetUp() override {
    InDirectory::SetUp();
    fs::create_directory("home");
    spill("case.yaml", slurp("case.yaml") + "load: -20\n");
  }
};

/// Command line over case file over PETSc's files and variables, of which the last one counts.
TEST_F(Options, ComeFromThreePlaces) {
  const double mine = energy(solved(""));
  spill("home/.petscrc", "-load -3\n-frame_height 0.01\n");
  spill(".petscrc", "-load -4\n");
  const std::string file = solved("");
  EXPECT_NE(energy(file), mine); // the frame is of the user's file alone
  EXPECT_TRUE(contains(line_with(file, "Options from outside: "), "home/.petscrc)"));
  EXPECT_TRUE(contains(file, "-load -4 (.petscrc), not used for that (line 6 of case.yaml)"));
  EXPECT_EQ(energy(solved("", "-skip_petscrc")), mine);
  EXPECT_EQ(energy(solved("", "-frame_height 0")), mine);
  const std::string last = solved("PETSC_OPTIONS=-load\\ -5");
  EXPECT_TRUE(contains(last, "-load -5 (PETSC_OPTIONS), not used")) << last;
  EXPECT_EQ(energy(last), energy(file));
  EXPECT_NE(energy(solved("PETSC_OPTIONS=-load\\ -5", "-load -21")), energy(file));
}

TEST_F(Options, FromOutsideAreNamedWhereTheyAreRefused) {
  const auto refused = [](const std::string &options, const std::string &part) {
    const std::string arguments = "solve -case case.yaml -mu 0.2,0,0 -csv x.csv";
    const Finished run = shell("env PETSC_OPTIONS='" + options + "' " + rbvi(2, arguments));
    expect_refused({arguments, part}, run, 2);
    EXPECT_TRUE(contains(run.err, "(PETSC_OPTIONS)")) << run.err;
    EXPECT_FALSE(fs::exists("x.csv"));
  };
  refused("-trian 3", "unknown option -trian (PETSC_OPTIONS)");
  refused("-frame_tilt 7", "options from outside: -frame_tilt 7 (PETSC_OPTIONS)");
}

TEST_F(Options, WithoutEffectAreRefused) {
  const std::string disk =
      "offline -case " RBVI_CASES "/rigid_disk -arc_edges 40 -train grid:3 -out run ";
  const std::string patch = "offline -case " RBVI_CASES "/patch -train grid:3 -out run ";
  expect_all_refused(
      {{disk + "-nitsche_loop single", "set -formulation nitsche"},
       {disk + "-formulation nitsche -friction tresca -nitsche_loop single", "-friction coulomb"},
       {disk + "-formulation nitsche -nitsche_eim_tolerance 0.1", "quadrature interpolated"},
       {disk + "-nitsche_gamma0 100", "-nitsche_gamma0 has no effect"},
       {disk + "-friction none -friction_coefficient 0.3",
        "-friction_coefficient has no effect with -friction none"},
       {disk + "-friction none -parameters radius,friction_coefficient",
        "'friction_coefficient' has no effect with -friction none"},
       {disk + "-uzawa_step 1", "it is for -hf_method uzawa"},
       {disk + "-nonlinear_max_steps 7", "set -kinematics large"},
       {disk + "-gcns_tolerance 0.1", "it is for -multiplier_reduction collocated"},
       {disk + "-multiplier_reduction condensed -cone_type nodal",
        "it is for -multiplier_reduction cone or collocated"},
       {"offline -case " RBVI_CASES
        "/membrane_obstacle -train grid:2 -out run -response_tolerance 0",
        "it is for -multiplier_reduction condensed or collocated"},
       {disk + "-hf_method uzawa -hf_contact condensed", "it is for -hf_method active_set"},
       {disk + "-formulation nitsche -cone_max_size 4", "Nitsche's method has no multipliers"},
       {disk + "-formulation nitsche -hf_contact condensed", "Nitsche's method has no multipliers"},
       {disk + "-young 10 -young 20", "-young is given twice"},
       {disk + "-mu 1", "it is for rbvi solve"},
       {patch + "-shear 0.1", "option -shear needs -bodies one"},
       {patch + "-parameters indentation,shear", "parameter 'shear' needs -bodies one"},
       {patch + "-disc_map graded", "unknown option -disc_map"}});
}

TEST_F(Options, ACaseAndASceneAreOfOneScene) {
  spill("own.yaml", "case: " RBVI_CASES "/membrane_obstacle\noptions_file: x\n");
  expect_all_refused({{"offline -case case.yaml -scene patch -out run",
                       "-scene names a scene of the program, and " RBVI_CASES
                       "/membrane_obstacle/case.yaml is a case"},
                      {"verify -out run", "no case is named, and run is no directory of a run"},
                      {"solve -case own.yaml -mu 0.2,0,0",
                       "option -options_file (line 2 of own.yaml) is PETSc's own"}});
}

/// A single solve outside the training box says what it takes.
TEST_F(Options, ASingleSolveOutsideTheBoxSaysWhatToAdd) {
  const std::string solve = "solve -case " RBVI_CASES "/patch -mu 0.001 ";
  expect_all_refused({{solve, "outside [0.01, 0.1]: add -indentation 0.001,0.1 for a wider box"},
                      {"solve -case " RBVI_CASES "/rigid_disk -indentation 0.1 -mu 1",
                       "for a single solve narrow the box around -mu (-radius LOWER,UPPER)"}});
  EXPECT_TRUE(contains(output_of(rbvi(1, solve + "-indentation 0.001,0.1")), "kkt_residual"));
  const std::string disk =
      "solve -case " RBVI_CASES "/rigid_disk -arc_edges 40 -indentation 0.1 -mu 1 ";
  EXPECT_TRUE(contains(output_of(rbvi(1, disk + "-radius 0.9,1.1")), "kkt_residual"));
}

TEST_F(Options, HelpOfACommandIsItsOwn) {
  const std::string offline = output_of(rbvi(1, "offline -help")),
                    solve = output_of(rbvi(1, "solve --help"));
  EXPECT_TRUE(contains(offline, "-pod_tolerance"));
  EXPECT_FALSE(contains(offline, "-bench_growth"));
  EXPECT_FALSE(contains(offline, "  -mu "));
  EXPECT_TRUE(contains(solve, "  -mu "));
  EXPECT_TRUE(contains(solve, "-uzawa_tolerance"));
  EXPECT_FALSE(contains(solve, "-pod_tolerance"));
  EXPECT_EQ(lines_with(output_of(rbvi(1, "inspect -help")), "rbvi inspect FILE"), 1);
}

/// What is printed is there at once, in a file too, and stays if the process is ended.
TEST_F(Options, OutputIsThereWhenAProcessIsEnded) {
  (void)shell("sh -c '" RBVI_TOOL " offline -case case.yaml -train grid:20,20,20 -out run > log & "
              "for i in $(seq 100); do sleep 0.1; test -s log && break; done; kill -KILL $!'");
  EXPECT_TRUE(contains(slurp("log"), "snapshots")) << slurp("log");
}

} // namespace
} // namespace rbvi::options_test
