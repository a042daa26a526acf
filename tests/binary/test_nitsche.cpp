// Nitsche's method with both tools from outside: a whole run on 2 ranks, what it says, and bad
// input.
#include "run.hpp"

namespace rbvi::nitsche_test {
namespace {

struct Nitsche : InDirectory {
  void SetUp() override {
    InDirectory::SetUp();
    spill("disk.yaml", "scene: rigid_disk\n"
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
       {"solution", "bases", "pressure", "error_map", "mesh_quality", "errors"})
    for (const std::string kind : {".png", ".pdf"})
      EXPECT_TRUE(contains(drawn, figure + kind)) << drawn;
  const std::string inspect = output_of(rbvi_online("run/model.h5"));
  EXPECT_TRUE(contains(inspect, "of 160 Gauss points")) << inspect;
}

TEST_F(Nitsche, BadInputIsSaidInOneLine) {
  const std::string offline = "offline -case disk.yaml -out run ";
  expect_all_refused({{offline + "-hf_method uzawa", "mixed formulation"},
                      {offline + "-multiplier_reduction joint", "for the mixed formulation"},
                      {offline + "-nitsche_gamma0 -1", "nitsche_gamma0"},
                      {offline + "-nitsche_gamma 5", "-nitsche_gamma0"},
                      {offline + "-formulation mixed -nitsche_quadrature full", "-formulation"},
                      {offline + "-nitsche_snes_typo 3", "-nitsche_snes_typo"},
                      {offline + "-nitsche_snes_stol 1e-3", "use -nitsche_snes_rtol"},
                      {offline + "-nitsche_snes_divergence_tolerance 9", "use -nitsche_snes_rtol"},
                      {offline + "-nitsche_snes_lag_preconditioner 2", "use -nitsche_ksp_rtol"},
                      {offline + "-hf_pc_type lu", "Nitsche's method has -nitsche_pc_type"}});
}

TEST_F(Nitsche, AGammaThatIsTooSmallIsAFailureThatSaysWhatToTry) {
  expect_refused({"", "raise -nitsche_gamma0", 1},
                 shell(rbvi(1, "solve -case disk.yaml -mu 1 -nitsche_gamma0 0.1")), 1);
}

} // namespace
} // namespace rbvi::nitsche_test
