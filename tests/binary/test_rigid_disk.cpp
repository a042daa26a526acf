// Contact with friction with both tools from outside: a whole run on 2 ranks, what it skips, and
// bad input.
#include "rbvi/core/parameters.hpp"
#include "run.hpp"

namespace rbvi {
namespace {

struct RigidDisk : InDirectory {
  void SetUp() override {
    InDirectory::SetUp();
    spill("disk.yaml", "scene: rigid_disk\n"
                       "arc_edges: 40\n"
                       "train: grid:9\n"
                       "valid: random:3:1\n"
                       "pod_tolerance: 1e-6\n"
                       "eim_tolerance: 1e-10\n");
  }
};

TEST_F(RigidDisk, IsReducedVerifiedAndAsked) {
  const Finished offline = shell(rbvi(2, "offline -case disk.yaml -out run"));
  ASSERT_EQ(offline.status, 0) << offline.err;
  EXPECT_EQ(offline.err, "");
  EXPECT_TRUE(contains(offline.out, "9 solved by 2 groups of 1 rank")) << offline.out;
  EXPECT_TRUE(contains(offline.out, "1 factorisation, 1 term")) << offline.out;

  const Finished verify = shell(rbvi(2, "verify -out run"));
  ASSERT_EQ(verify.status, 0) << verify.err;
  EXPECT_EQ(verify.err, "");
  EXPECT_TRUE(contains(verify.out, "lambda_tau")) << verify.out;
  for (const char *table : {"errors", "summary", "error_map", "worst_pressure", "samples"})
    EXPECT_TRUE(fs::exists(std::string("run/verify/") + table + ".csv")) << table;

  const Finished online = shell(rbvi_online("run/model.h5 --mu 0.85 --vtu u.vtu"));
  ASSERT_EQ(online.status, 0) << online.err;
  const Finished solve = shell(rbvi(2, "solve -case disk.yaml -mu 0.85 -vtu full.vtu"));
  ASSERT_EQ(solve.status, 0) << solve.err;
  const auto line = [](const std::string &text, const std::string &name) {
    const std::size_t at = text.find("\n" + name + " ");
    return parse_number(text.substr(at + 23, text.find('\n', at + 1) - at - 23), name);
  };
  for (const char *name : {"energy", "normal_force", "tangential_force", "reaction",
                           "contact_half_width", "stick_half_width", "peak_pressure"}) {
    const double truth = line(solve.out, name);
    EXPECT_NEAR(line(online.out, name), truth, 1e-6 * truth) << name;
  }
  for (const char *file : {"u.vtu", "full.vtu"})
    EXPECT_TRUE(contains(slurp(file), ">22\n") || contains(slurp(file), "\n22\n")) << file;
  for (const char *file : {"u_contact.vtu", "full_contact.vtu"}) {
    const std::string curve = slurp(file);
    for (const char *field : {"pressure", "tangential_stress", "gap", "u"})
      EXPECT_TRUE(contains(curve, "Name=\"" + std::string(field) + "\"")) << file << field;
  }
}

TEST_F(RigidDisk, BadInputIsSaidInOneLine) {
  const std::string offline = "offline -case disk.yaml -out run ";
  const std::pair<std::string, std::string> cases[] = {
      {offline + "-friction slippery", "use one of none, tresca, coulomb"},
      {offline + "-arc_edges 7", "must be even and at least 8"},
      {offline + "-multiplier_reduction best", "condensed"},
      {offline + "-multiplier_reduction joint -friction none", "the scene has no friction"},
      {offline + "-multiplier_reduction cones -cone_type hybrid",
       "-cone_type hybrid has functions of either sign"},
      {offline + "-hf_method vi", "use active_set or uzawa"},
      {"solve -case disk.yaml -mu 1.5", "radius = 1.5 is outside [0.7, 1.3]"},
      {"solve -case disk.yaml -parameters radius,viscosity -mu 1,1", "viscosity"}};
  int ranks = 1;
  for (const auto &[arguments, part] : cases) {
    ranks = 3 - ranks;
    const Finished run = shell(rbvi(ranks, arguments));
    SCOPED_TRACE(arguments + ": status " + std::to_string(run.status) + "\n" + run.err);
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(lines_with(run.err, "rbvi: "), 1);
    EXPECT_TRUE(contains(run.err, part)) << "expected: " << part;
    EXPECT_FALSE(contains(run.err, "PETSC ERROR"));
  }
}

} // namespace
} // namespace rbvi
