// Nitsche's method with both tools from outside: a whole run on 2 ranks, what it says, and bad
// input.
#include "run.hpp"

namespace rbvi::nitsche_test {
namespace {

struct Nitsche : InDirectory {
  void SetUp() override {
    InDirectory::SetUp();
    spill("disk.yaml", "case: " RBVI_CASES "/rigid_disk\n"
                       "formulation: nitsche\n"
                       "arc_edges: 40\n"
                       "train: grid:9\n"
                       "valid: random:3:1\n"
                       "pod_tolerance: 1e-4\n");
  }
};

TEST_F(Nitsche, IsReducedVerifiedAndAsked) {
  const std::string offline = output_of(rbvi(2, "offline -case disk.yaml -out run"));
  EXPECT_TRUE(contains(offline, "9 solved by 2 groups of 1 rank")) << offline;
  EXPECT_TRUE(contains(offline, "skipped: Nitsche's method has no multipliers")) << offline;
  const std::string verify = verified();
  EXPECT_TRUE(contains(verify, "nitsche empirical")) << verify;
  EXPECT_TRUE(contains(verify, "Inf-sup constants: none, Nitsche's method")) << verify;

  const std::string online = output_of(rbvi_online("run/model.h5 --mu 0.85 --vtu run/u.vtu"));
  const std::string solve = output_of(rbvi(2, "solve -case disk.yaml -mu 0.85 -vtu full.vtu"));
  for (const char *name : {"energy", "normal_force", "tangential_force", "reaction"}) {
    const double truth = value_of(solve, name);
    EXPECT_NEAR(value_of(online, name), truth, 1e-2 * truth) << name;
  }
  for (const char *file : {"run/u_contact.vtu", "full_contact.vtu"})
    expect_fields(file, {"pressure", "tangential_stress", "gap", "u", "mu_radius"});
  expect_fields("full.vtu",
                {"u", "von_mises", "sigma_xx", "sigma_yy", "sigma_xy", "sigma_zz", "body"});
  const std::string drawn = output_of(RBVI_FIGURES " run");
  for (const std::string figure :
       {"solution", "bases", "outputs", "pressure", "error_map", "errors"})
    for (const std::string kind : {".png", ".pdf"})
      EXPECT_TRUE(contains(drawn, "run/figures/" + figure + kind)) << drawn;
  EXPECT_TRUE(contains(drawn, "mesh_quality.png: left out, the largest aspect ratio is ")) << drawn;
  const std::string inspect = output_of(rbvi_online("run/model.h5"));
  EXPECT_TRUE(contains(inspect, "of 160 Gauss points")) << inspect;
}

/// Where the normal of contact is not that of the body, whose stress the method takes, it is as
/// close to the laws and to the answer by multipliers as where it is.
TEST_F(Nitsche, FulfilsTheLawsAlongAnyNormal) {
  const auto solved = [](const std::string &options) {
    return output_of(
        rbvi(1, "solve -case " RBVI_CASES "/rigid_disk -arc_edges 80 -mu 1 " + options));
  };
  for (const std::string normal : {"radial", "rigid"}) {
    SCOPED_TRACE(normal);
    const std::string common = "-friction none -normal " + normal + " -formulation ";
    const std::string nitsche = solved(common + "nitsche"), mixed = solved(common + "mixed");
    EXPECT_LT(value_of(nitsche, "law_error_normal"), 0.04)
        << "0.1 with the stress on another normal";
    const double energy = value_of(mixed, "energy"), peak = value_of(mixed, "peak_pressure");
    EXPECT_NEAR(value_of(nitsche, "energy"), energy, 1e-5 * energy);
    EXPECT_NEAR(value_of(nitsche, "peak_pressure"), peak, 1e-2 * peak);
  }
  const std::string lifted =
      output_of(rbvi(1, "solve -case " RBVI_CASES
                        "/roller -formulation nitsche -top -0.1 -parameters tilt -mu 0"));
  EXPECT_LT(value_of(lifted, "law_error_normal"), 0.2) << "of two arcs one is not touched";
}

/// Chapter 4 as it is: the published iteration answers where it converges.
TEST_F(Nitsche, ThePublishedVariantIsVerifiedByThePublishedIteration) {
  const std::string offline = output_of(rbvi(
      1, "offline -case " RBVI_CASES "/rigid_disk -variant nitsche_published -friction tresca "
         "-arc_edges 40 -train 'grid:9 in radius=0.7,1.15' -valid 'random:3:1 in radius=0.7,1.1' "
         "-out run"));
  EXPECT_TRUE(contains(offline, "9 solved")) << offline;
  EXPECT_TRUE(contains(offline, "terms: B^n + B^tau ")) << offline;
  const std::string verify = output_of(rbvi(1, "verify -out run"));
  EXPECT_TRUE(contains(verify, "nitsche interpolated")) << verify;
  const std::string usual = output_of(rbvi_online("run/model.h5 --mu 0.85 --method exact")),
                    newton = output_of(rbvi_online("run/model.h5 --mu 0.85"));
  EXPECT_NEAR(value_of(newton, "energy"), value_of(usual, "energy"),
              1e-8 * value_of(usual, "energy"));
  EXPECT_NE(value_of(newton, "iterations"), value_of(usual, "iterations"));
  const Finished refused = shell(rbvi_online("run/model.h5 --mu 0.85 --method other"));
  EXPECT_EQ(refused.status, 2);
  EXPECT_TRUE(contains(refused.err, "use one of exact")) << refused.err;
}

/// Where the method of its queries has no answer the self-check says so, and the model is there.
TEST_F(Nitsche, TheSelfCheckAsksByTheMethodOfTheModel) {
  const std::string offline = output_of(
      rbvi(1, "offline -case " RBVI_CASES
              "/rigid_disk -variant nitsche_published -arc_edges 40 -train random:8:3 -out run"));
  EXPECT_TRUE(contains(offline, " without an answer")) << offline;
  EXPECT_TRUE(contains(offline, "the interpolated problem did not converge")) << offline;
  const std::string at = "run/model.h5 --mu 1.299227652462021";
  EXPECT_EQ(shell(rbvi_online(at)).status, 1);
  EXPECT_GT(value_of(output_of(rbvi_online(at + " --method exact")), "energy"), 0);
}

TEST_F(Nitsche, BadInputIsSaidInOneLine) {
  const std::string offline = "offline -case disk.yaml -out run ";
  expect_all_refused({{offline + "-hf_method uzawa", "mixed formulation"},
                      {offline + "-multiplier_reduction collocated", "for the mixed formulation"},
                      {offline + "-nitsche_gamma0 -1", "nitsche_gamma0"},
                      {offline + "-nitsche_gamma 5", "-nitsche_gamma0"},
                      {offline + "-formulation mixed -nitsche_quadrature full", "-formulation"},
                      {offline + "-nitsche_snes_typo 3", "-nitsche_snes_typo"},
                      {offline + "-nitsche_snes_lag_preconditioner 2", "use -nitsche_ksp_rtol"},
                      {offline + "-hf_pc_type lu", "Nitsche's method has -nitsche_pc_type"}});
}

TEST_F(Nitsche, AGammaThatIsTooSmallIsAFailureThatSaysWhatToTry) {
  expect_refused({"", "raise -nitsche_gamma0", 1},
                 shell(rbvi(1, "solve -case disk.yaml -mu 1 -nitsche_gamma0 0.1")), 1);
}

} // namespace
} // namespace rbvi::nitsche_test
