// Two bodies with friction from a case file to an online answer, on 1 and 2 ranks.
#include "run.hpp"

namespace rbvi::friction_of_bodies_test {
namespace {

/// Blocks whose meshes do not match, with free sides: the upper one is pressed and moved sideways.
const char *const blocks =
    "rbvi: 1\n"
    "physics: plane_strain\n"
    "mesh: {built_in: two_blocks, degree: 1}\n"
    "parameters:\n"
    "  shear: {range: [0, 0.1], default: 0.02}\n"
    "  friction: {range: [0, 0.6], default: 0.3}\n"
    "  depth: {range: [0.02, 0.1], default: 0.05}\n"
    "map: [x, 'y > 0 ? y - 0.25 : y + 0.25']\n"
    "motion: ['y > 0 ? shear : 0', 'y > 0 ? -depth : 0']\n"
    "materials: {rubber: {at: all, E: 15, nu: 0.35}}\n"
    "imposed:\n"
    "  top: {at: top, ux: motion, uy: motion}\n"
    "  bottom: {at: bottom, ux: motion, uy: motion}\n"
    "contact:\n"
    "  between: {at: slave, against: master, friction: {coulomb: friction}}\n"
    "train: grid:3,3,3\n"
    "validate: random:5:1\n";

struct FrictionOfBodies : InDirectory {
  void SetUp() override {
    InDirectory::SetUp();
    fs::create_directory("blocks");
    spill("blocks/case.yaml", blocks);
  }
};

TEST_F(FrictionOfBodies, IsKeptByTheReducedModel) {
  for (const int ranks : {1, 2}) {
    const std::string run = "run" + std::to_string(ranks);
    (void)output_of(rbvi(ranks, "offline -case blocks -out " + run));
    const std::string verify = output_of(rbvi(ranks, "verify -out " + run));
    EXPECT_TRUE(contains(verify, "over 5 validation mu")) << verify;
    for (const char *mu : {"0.03,0.3,0.05", "0.08,0.2,0.04", "0.01,0.5,0.09"}) {
      const std::string online =
          output_of(rbvi_online(run + "/model.h5 --mu " + mu + " --vtu u.vtu"));
      const std::string solve =
          output_of(rbvi(ranks, std::string("solve -case blocks -vtu full.vtu -mu ") + mu));
      for (const char *name : {"energy", "normal_force", "tangential_force", "reaction",
                               "horizontal_reaction", "peak_pressure", "stick_half_width"}) {
        const double truth = value_of(solve, name);
        EXPECT_NEAR(value_of(online, name), truth, 1e-8 * std::max(1.0, std::abs(truth)))
            << name << " at " << mu;
      }
      EXPECT_LE(value_of(online, "expected_error_lambda"), 1e-9);
      EXPECT_LE(value_of(online, "tangential_force"),
                value_of(online, "normal_force") * std::stod(std::string(mu).substr(5, 3)) + 1e-9);
      for (const char *file : {"u_contact.vtu", "full_contact.vtu"})
        expect_fields(file, {"pressure", "tangential_stress", "gap", "u"});
    }
  }
}

TEST_F(FrictionOfBodies, MayHaveALimitThatTheModelKnows) {
  std::string text = blocks;
  const std::string law = "{coulomb: friction}";
  text.replace(text.find(law), law.size(), "{coulomb: friction, limit: 0.1 + 0.1 * friction}");
  spill("blocks/case.yaml", text);
  (void)output_of(rbvi(1, "offline -case blocks -out limited"));
  for (const auto &[mu, most] : {std::pair{"0.09,0.6,0.08", 0.16}, {"0.05,0.2,0.09", 0.12}}) {
    const std::string online = output_of(rbvi_online(std::string("limited/model.h5 --mu ") + mu));
    const std::string solve = output_of(rbvi(1, std::string("solve -case blocks -mu ") + mu));
    for (const char *name : {"energy", "normal_force", "tangential_force", "peak_pressure"})
      EXPECT_NEAR(value_of(online, name), value_of(solve, name), 1e-8) << name << " at " << mu;
    EXPECT_NEAR(value_of(solve, "tangential_force"), most, 1e-9) << "all of it slides at the limit";
  }
}

} // namespace
} // namespace rbvi::friction_of_bodies_test
