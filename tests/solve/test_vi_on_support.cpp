// Vertex quadrature on a rigid support: the constraint is one at each vertex, every solver takes
// it, and the bound-constrained primal problem in local frames has the same solution.
#include "block_on_support.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/solve/methods.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

namespace rbvi::vi_on_support_test {
namespace {

/// Free: radius, indentation, friction, core_stiffness, poisson_ratio.
Scene disk(const std::string &friction, SceneOptions options = {{"arc_edges", "40"}}) {
  options["friction"] = friction;
  options["lumped"] = "yes";
  Scene scene = make_scene("rigid_disk", options);
  scene.parameters.free = {0, 1, 2, 3, 4};                    // all but the offset
  if (!has_friction(scene)) scene.parameters.free.pop_back(); // there is no such parameter
  return scene;
}

HfOptions with_vi() {
  HfOptions options;
  options.method = HfMethod::vi;
  return options;
}

void expect_same(const HfSolution &vi, const HfSolution &truth) {
  EXPECT_GT(truth.lambda.norm(), 0);
  EXPECT_LE(std::abs(*vi.outputs.energy - *truth.outputs.energy), 1e-9 * *truth.outputs.energy);
  EXPECT_LE((vi.u - truth.u).norm(), 1e-8 * truth.u.norm());
  EXPECT_LE((vi.lambda - truth.lambda).norm(), 1e-8 * truth.lambda.norm());
  EXPECT_EQ(vi.active, truth.active);
}

const Mu several[] = {
    {1, 0.09, 1, 0.35}, {0.7, 0.09, 1, 0.35}, {1.3, 0.01, 1, 0.35}, {1, 0.05, 5, 0.2}};

TEST(ViOnSupport, AgreesWithTheActiveSet) {
  for (const char *normal : {"radial", "rigid"}) {
    Problem problem(PETSC_COMM_WORLD, disk("none", {{"arc_edges", "40"}, {"normal", normal}}), {});
    HighFidelity active_set(problem, {}), vi(problem, with_vi());
    for (const Mu &mu : several) {
      SCOPED_TRACE(describe(problem.scene().parameters, mu) + ", normal " + normal);
      const HfSolution truth = active_set.solve(mu);
      for (const char *type : {SNESVINEWTONRSLS, SNESVINEWTONSSLS}) {
        SCOPED_TRACE(type);
        RBVI_CALL(PetscOptionsSetValue(nullptr, "-vi_snes_type", type));
        expect_same(vi.solve(mu), truth);
      }
      RBVI_CALL(PetscOptionsClearValue(nullptr, "-vi_snes_type"));
    }
  }
}

/// Whatever the unit of pressure is.
TEST(ViOnSupport, ABodyMayBeSoftOrStiff) {
  for (const char *young : {"1e-6", "1e15"}) {
    Problem problem(PETSC_COMM_WORLD, disk("none", {{"arc_edges", "40"}, {"young", young}}), {});
    const HfSolution truth = HighFidelity(problem, {}).solve(several[0]);
    expect_same(HighFidelity(problem, with_vi()).solve(several[0]), truth);
  }
}

TEST(ViOnSupport, IsTheSameOnAnyNumberOfRanks) {
  const Mu mu = several[1];
  Problem shared(PETSC_COMM_WORLD, disk("none"), {}), own(PETSC_COMM_SELF, disk("none"), {});
  const HfSolution a = HighFidelity(shared, with_vi()).solve(mu);
  const HfSolution b = HighFidelity(own, with_vi()).solve(mu);
  EXPECT_LE((a.u - b.u).norm(), 1e-10 * b.u.norm());
  EXPECT_LE((a.lambda - b.lambda).norm(), 1e-10 * b.lambda.norm());
}

TEST(ViOnSupport, RefusesFrictionAndIntegralsOverSeveralNodes) {
  for (const auto &[scene, says] :
       {std::pair{disk("coulomb"), "-friction none"},
        std::pair{make_scene("rigid_disk", {{"friction", "none"}, {"arc_edges", "40"}}),
                  "-lumped"}}) {
    Problem problem(PETSC_COMM_WORLD, scene, {});
    try {
      HighFidelity(problem, with_vi());
      FAIL() << says;
    } catch (const Error &error) {
      EXPECT_EQ(error.status(), Status::bad_input);
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  }
}

Mu with_friction(const std::string &law) {
  return law == "none" ? Mu{1, 0.09, 1, 0.35} : Mu{1, 0.09, 0.1, 1, 0.35};
}

TEST(LumpedSupport, HoldsTheGapAtEveryVertex) {
  for (const char *law : {"none", "tresca", "coulomb"}) {
    Problem problem(PETSC_COMM_WORLD, disk(law), {});
    const HfSolution s = HighFidelity(problem, {}).solve(with_friction(law));
    EXPECT_LE(s.kkt.largest(), 1e-10) << law;
    EXPECT_LE(*s.outputs.max_penetration, 1e-12) << law;
  }
}

TEST(LumpedSupport, UzawaComesToTheSameAnswer) {
  HfOptions options;
  options.method = HfMethod::uzawa;
  options.uzawa.accelerated = true;
  options.uzawa.tolerance = 1e-9;
  for (const char *law : {"none", "tresca", "coulomb"}) {
    const Mu mu = with_friction(law);
    Problem problem(PETSC_COMM_WORLD, disk(law), {});
    const HfSolution truth = HighFidelity(problem, {}).solve(mu);
    const HfSolution s = HighFidelity(problem, options).solve(mu);
    EXPECT_LE((s.u - truth.u).norm(), 1e-5 * truth.u.norm()) << law;
    EXPECT_LE((s.lambda - truth.lambda).norm(), 1e-4 * truth.lambda.norm()) << law;
  }
}

/// Vertex quadrature of degree 1 takes a constant stress as it is.
TEST(LumpedSupport, PassesThePatchTest) {
  const Mu mu{0.05, 0.02, 0.3};
  for (const char *friction : {"none", "coulomb"}) {
    SceneOptions options = block_on_support::block("1", friction).options;
    options["lumped"] = "yes";
    Scene scene = make_scene("patch", options);
    scene.parameters = all_free(scene.parameters.all);
    Problem problem(PETSC_COMM_WORLD, scene, {});
    const block_on_support::Exact exact(mu, friction == std::string("none"));
    for (const HfMethod method : {HfMethod::active_set, HfMethod::vi}) {
      if (method == HfMethod::vi && friction == std::string("coulomb")) continue;
      HfOptions hf;
      hf.method = method;
      const HfSolution s = HighFidelity(problem, hf).solve(mu);
      const Index count = problem.contact().nodes();
      EXPECT_LE((s.lambda.head(count).array() - exact.pressure).abs().maxCoeff(),
                1e-12 * exact.pressure);
      EXPECT_LE(block_on_support::displacement_error(problem, mu, exact, s), 1e-13);
    }
  }
}

/// To frictionless contact in the continuum, computed by other software on graded meshes, at first
/// order: the forces at the vertices bend the edges of degree 2 between them into the support.
TEST(LumpedSupport, TendsToTheContinuumAtFirstOrder) {
  const double energy = 0.0408828, force = 1.03483;
  std::vector<double> energies, forces;
  for (const char *edges : {"50", "100", "200"}) {
    Problem problem(PETSC_COMM_WORLD, disk("none", {{"arc_edges", edges}}), {});
    const Outputs out = HighFidelity(problem, {}).solve(several[0]).outputs;
    energies.push_back(std::abs(*out.energy / energy - 1));
    forces.push_back(std::abs(*out.normal_force / force - 1));
  }
  for (const auto &errors : {energies, forces}) {
    EXPECT_NEAR(std::log2(errors[0] / errors[1]), 1, 0.1);
    EXPECT_NEAR(std::log2(errors[1] / errors[2]), 1, 0.1);
    EXPECT_LE(errors[2], 6e-3);
  }
}

} // namespace
} // namespace rbvi::vi_on_support_test
