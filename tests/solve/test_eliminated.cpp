// Contact by eliminated displacements is contact by condensed multipliers.
#include "rbvi/core/error.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/scene/case.hpp"
#include "rbvi/solve/contact_cost.hpp"
#include "rbvi/solve/eliminated.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

namespace rbvi::eliminated_test {
namespace {

using SceneValues = std::map<std::string, std::string>;

void expect_equal(const HfSolution &found, const HfSolution &expected) {
  EXPECT_LE((found.u - expected.u).norm(), 1e-10 * expected.u.norm());
  EXPECT_LE((found.lambda - expected.lambda).norm(), 1e-9 * expected.lambda.norm());
  EXPECT_EQ(found.active, expected.active);
  EXPECT_LE(found.kkt.largest(), 1e-10);
  for (const auto member : {&Outputs::energy, &Outputs::normal_force, &Outputs::contact_measure,
                            &Outputs::peak_pressure})
    EXPECT_NEAR(*(found.outputs.*member), *(expected.outputs.*member),
                1e-10 * (1 + std::abs(*(expected.outputs.*member))));
}

/// The second parameter from the sets, and with the factors, of the first. Each rank has its own
/// rows of B alone where they are eliminated, all of them where they are condensed.
void expect_agreement(const std::string &name, const SceneValues &values,
                      const std::vector<Mu> &set, int refine = 0) {
  if (ranks_of(PETSC_COMM_WORLD) > 1 && refine > 0) return; // one rank has seen the fine mesh
  SCOPED_TRACE(name + (values.empty() ? "" : " " + values.begin()->second));
  Problem whole(PETSC_COMM_WORLD, make_scene(name, values), {"", refine});
  Problem split(PETSC_COMM_WORLD, make_scene(name, values), {"", refine}, /*contact_gather=*/0);
  HfOptions condensed, eliminated;
  condensed.contact = HfContact::condensed;
  eliminated.contact = HfContact::eliminated;
  HighFidelity one(whole, condensed), other(split, eliminated);
  for (const Mu &mu : set) {
    const HfSolution expected = one.solve(mu);
    expect_equal(other.solve(mu), expected);
  }
}

TEST(Eliminated, AgreesOnObstacles) {
  const std::vector<Mu> set{{0.17, -0.03, 0.05}, {0.22, 0.02, 0.01}};
  for (const std::string lumped : {"yes", "no"})
    for (const int refine : {0, 1})
      expect_agreement("membrane_obstacle", {{"circle_edges", "24"}, {"lumped", lumped}}, set,
                       refine);
}

/// The integrals of the functions of vertices of degree 2 against hats are no mass matrix.
TEST(Eliminated, AgreesOnARoofUnderDegreeTwo) {
  const Scene scene = make_scene(
      read_case("rbvi: 1\nphysics: membrane\nmesh: {built_in: square_with_disc, edges: 24, degree: "
                "2}\nparameters: {height: {range: [-0.1, 0.1], default: 0}}\n"
                "imposed: {rim: {at: boundary, u: 0}}\nloads: {push: {at: all, force: -25}}\n"
                "contact: {rock: {at: obstacle, lumped: no, "
                "above: height - 0.3 * (abs(x + 0.03) + abs(y))}}\n",
                "case.yaml"),
      {});
  Problem problem(PETSC_COMM_WORLD, scene, {});
  HfOptions condensed, eliminated;
  condensed.contact = HfContact::condensed;
  eliminated.contact = HfContact::eliminated;
  HighFidelity one(problem, condensed), other(problem, eliminated);
  for (const double height : {-0.1, -0.05, 0.0, 0.1})
    expect_equal(other.solve({height}), one.solve({height}));
}

/// A block of height 0.5 over a floor at `position`.
Scene block(const std::string &position, const std::string &rest) {
  return make_scene(
      read_case("rbvi: 1\nphysics: plane_strain\nmesh: {built_in: one_block, degree: 2}\n"
                "materials: {r: {at: all, E: 100, nu: 0.3}}\ncontact: {floor: {at: contact, "
                "against: {plane: {normal: [0, -1], position: " +
                    position + "}}}}\n" + rest,
                "case.yaml"),
      {});
}

/// What the answer before pressed with says nothing of one without load, which is zero.
TEST(Eliminated, ForgetsTheForcesOfTheAnswerBefore) {
  Problem problem(PETSC_COMM_WORLD,
                  block("room",
                        "parameters: {press: {range: [0, 1], default: 1}, room: {range: [-0.01, "
                        "0.1], default: 0}}\nimposed: {side: {at: top, ux: 0, uy: 0}}\n"
                        "loads: {own: {at: all, force: [0, -press]}}\n"),
                  {});
  HfOptions eliminated;
  eliminated.contact = HfContact::eliminated;
  HighFidelity solver(problem, eliminated);
  EXPECT_GT(*solver.solve({1, 0}).outputs.normal_force, 0);
  const HfSolution found = solver.solve({0, 0.1});
  EXPECT_EQ(found.u.lpNorm<Eigen::Infinity>(), 0);
  EXPECT_EQ(found.kkt.largest(), 0);
}

/// A block that rests beside a soft spring: the round-off of its multipliers, over the stiffness,
/// moves it by more than a solution leaves.
TEST(Eliminated, TakesOverWhereMultipliersAreTooCoarse) {
  Problem problem(
      PETSC_COMM_WORLD,
      block("0", "parameters: {lift: {range: [0, 1], default: 0}}\n"
                 "imposed: {side: {at: sides, ux: 0}}\nsprings: {hold: {at: top, direction: [0, "
                 "1], stiffness: 0.001}}\nloads: {own: {at: all, force: [0, -1]}, pull: {at: "
                 "top, traction: [0, 0.1*lift]}}\n"),
      {});
  HfOptions condensed;
  condensed.contact = HfContact::condensed;
  EXPECT_THROW(HighFidelity(problem, condensed).solve({0}), Error);
  const HfSolution found = HighFidelity(problem, {}).solve({0});
  EXPECT_LE(found.kkt.largest(), 1e-10);
  const double modulus = 70 / 0.52; // lambda + 2 mu; the weight shortens it by height^2 / 2 of that
  EXPECT_NEAR(*found.outputs.normal_force, 0.5 - 0.001 * 0.125 / modulus, 1e-11);
}

TEST(Eliminated, AgreesOnSupportsUnderEveryLaw) {
  for (const std::string friction : {"none", "tresca", "coulomb"})
    expect_agreement("rigid_disk", {{"arc_edges", "60"}, {"friction", friction}}, {{0.9}, {1.2}});
  expect_agreement("rigid_disk", {{"arc_edges", "60"}, {"friction", "coulomb"}}, {{0.9}, {1.2}}, 1);
}

TEST(Eliminated, AgreesOnTwoBodies) {
  for (const std::string degree : {"1", "2"})
    for (const std::string multiplier : {"p0", "p1"})
      expect_agreement("two_disks",
                       {{"arc_edges", degree == "1" ? "140" : "60"},
                        {"degree", degree},
                        {"multiplier", multiplier}},
                       {{0.9}, {1.3}});
  expect_agreement("two_disks", {{"arc_edges", "60"}}, {{1.1}}, 1);
}

TEST(Eliminated, AgreesOnTwoInterfaces) {
  expect_agreement("roller", {}, {{0.03, 0.1}, {0.04, -0.05}});
  expect_agreement("roller", {{"friction", "none"}, {"lumped", "yes"}}, {{0.02, 0.01}});
}

TEST(Eliminated, TakesFewStepsFromACoarserMesh) {
  for (const std::string name : {"membrane_obstacle", "two_disks"}) {
    const Mu mu = name == "two_disks" ? Mu{1} : Mu{0.2, 0, 0};
    HfOptions options;
    options.contact = HfContact::eliminated;
    Problem fine(PETSC_COMM_WORLD, make_scene(name), {"", 1});
    EXPECT_LE(HighFidelity(fine, options).solve(mu).iterations, 5);
    Problem coarse(PETSC_COMM_WORLD, make_scene(name), {"", 0});
    EXPECT_GE(HighFidelity(coarse, options).solve(mu).iterations, 8);
  }
}

/// Also where another parameter has been solved: its sets are many layers of nodes away.
TEST(Eliminated, FineMeshesStartFromCoarserOnesAtEveryParameter) {
  if (ranks_of(PETSC_COMM_WORLD) > 1) return;
  Problem fine(PETSC_COMM_WORLD, make_scene("membrane_obstacle"), {"", 2});
  HfOptions options;
  options.contact = HfContact::eliminated;
  HighFidelity solver(fine, options);
  EXPECT_LE(solver.solve({0.16, -0.05, 0.05}).iterations, 5);
  const HfSolution after = solver.solve({0.24, 0.05, -0.05});
  EXPECT_LE(after.iterations, 5);
  expect_equal(after, HighFidelity(fine, options).solve({0.24, 0.05, -0.05}));
}

/// Above some size by multigrid: the answer is that of a factorisation.
TEST(Eliminated, AgreesByMultigrid) {
  Problem problem(PETSC_COMM_WORLD, make_scene("membrane_obstacle"), {"", 1});
  HfOptions options;
  options.contact = HfContact::eliminated;
  const Mu mu{0.18, 0.025, -0.025};
  const HfSolution by_multigrid = HighFidelity(problem, options).solve(mu);
  EXPECT_LE(by_multigrid.iterations, 5);
  RBVI_CALL(PetscOptionsSetValue(nullptr, "-hf_pc_type", "cholesky"));
  const HfSolution by_factors = HighFidelity(problem, options).solve(mu);
  RBVI_CALL(PetscOptionsClearValue(nullptr, "-hf_pc_type"));
  expect_equal(by_multigrid, by_factors);
}

/// Elastic bodies where an option asks for it: one cycle of multigrid a step, with their rigid-body
/// modes.
TEST(Eliminated, AgreesByMultigridOnElasticBodies) {
  for (const auto &[name, mu] :
       {std::pair{"rigid_disk", Mu{1.2}}, std::pair{"two_disks", Mu{0.9}}}) {
    SCOPED_TRACE(name);
    Problem problem(PETSC_COMM_WORLD, make_scene(name), {});
    HfOptions options;
    options.contact = HfContact::eliminated;
    const HfSolution by_factors = HighFidelity(problem, options).solve(mu);
    RBVI_CALL(PetscOptionsSetValue(nullptr, "-hf_pc_type", "gamg"));
    const HfSolution by_multigrid = HighFidelity(problem, options).solve(mu);
    RBVI_CALL(PetscOptionsClearValue(nullptr, "-hf_pc_type"));
    expect_equal(by_multigrid, by_factors);
    EXPECT_NE(by_multigrid.reason, by_factors.reason) << "it counts more Krylov steps";
  }
}

/// An option for as long as it lives.
struct WithOption {
  std::string name;
  WithOption(std::string option, const char *value) : name(std::move(option)) {
    RBVI_CALL(PetscOptionsSetValue(nullptr, name.c_str(), value));
  }
  ~WithOption() { (void)PetscOptionsClearValue(nullptr, name.c_str()); }
};

/// Symmetric and, under Coulomb's law, unsymmetric; one body and two, a region and boundaries.
TEST(Eliminated, WhereItFailsItsSystemsKeepTheirMultipliers) {
  struct Case {
    std::string scene;
    std::map<std::string, std::string> options;
  };
  HfOptions condensed, forced;
  condensed.contact = HfContact::condensed;
  forced.contact = HfContact::eliminated;
  for (const auto &[scene, options] :
       {Case{"membrane_obstacle", {{"circle_edges", "24"}}},
        Case{"membrane_obstacle", {{"circle_edges", "24"}, {"lumped", "yes"}}},
        Case{"two_disks", {}}, Case{"rigid_disk", {{"arc_edges", "40"}}},
        Case{"rigid_disk", {{"arc_edges", "40"}, {"friction", "tresca"}}}}) {
    SCOPED_TRACE(scene + (options.empty() ? "" : ", " + options.rbegin()->second));
    Problem problem(PETSC_COMM_WORLD, make_scene(scene, options), {});
    Mu mu;
    for (int i = 0; i < problem.scene().parameters.size(); ++i)
      mu.push_back(problem.scene().parameters.at(i).value);
    const HfSolution expected = HighFidelity(problem, condensed).solve(mu);
    // With exact factors one step suffices, but for such a tolerance.
    const WithOption one_step("-hf_krylov_ksp_max_it", "1"), rtol("-hf_krylov_ksp_rtol", "0"),
        atol("-hf_krylov_ksp_atol", "0");
    const HfSolution found = HighFidelity(problem, forced).solve(mu);
    expect_equal(found, expected);
    EXPECT_NE(found.reason.find("with multipliers because elimination failed"), std::string::npos)
        << found.reason;
  }
}

TEST(Eliminated, WhereTheyFailTooContactIsCondensedAndSaysSo) {
  Problem problem(PETSC_COMM_WORLD, make_scene("membrane_obstacle"), {"", 1}, 0);
  ASSERT_TRUE(eliminates(problem, {}));
  const Mu mu{0.18, 0.025, -0.025};
  HfOptions condensed, forced;
  condensed.contact = HfContact::condensed;
  forced.contact = HfContact::eliminated;
  const HfSolution expected = HighFidelity(problem, condensed).solve(mu);
  const WithOption one_step("-hf_krylov_ksp_max_it", "1"), nothing("-hf_saddle_pc_type", "none");
  const HfSolution found = HighFidelity(problem, {}).solve(mu);
  EXPECT_THROW(HighFidelity(problem, forced).solve(mu), Error);
  expect_equal(found, expected);
  EXPECT_NE(found.reason.find("condensed because elimination failed"), std::string::npos)
      << found.reason;
  EXPECT_EQ(expected.reason.find("elimination failed"), std::string::npos) << expected.reason;
}

TEST(Eliminated, KeepsItsFactorsWhileSetsChangeLittle) {
  Problem problem(PETSC_COMM_WORLD, make_scene("two_disks"), {});
  Eliminated solver(problem);
  (void)solver.solve(problem.assemble({1.0}), {});
  const int cold = solver.factorisations();
  const MethodResult first = solver.solve(problem.assemble({1.0}), {});
  const MethodResult next = solver.solve(problem.assemble({1.001}), first.start);
  EXPECT_TRUE(next.converged);
  EXPECT_LE(solver.factorisations(), cold + 2);
  EXPECT_LE(next.iterations, 4);
}

TEST(ContactCost, ChoosesTheCheaperOne) {
  const auto chosen = [](const std::string &name, int refine, int samples) {
    Problem problem(PETSC_COMM_WORLD, make_scene(name), {"", refine});
    HfOptions options;
    options.samples = samples;
    return eliminates(problem, options);
  };
  // At the default sizes, and where the columns are kept for a sweep, columns.
  for (const std::string name : {"membrane_obstacle", "two_disks", "rigid_disk", "roller"})
    for (const int samples : {1, 20})
      EXPECT_FALSE(chosen(name, 0, samples)) << name;
  EXPECT_FALSE(chosen("two_disks", 1, 20));
  EXPECT_FALSE(chosen("two_disks", 1, 1)) << "by a complement";
  EXPECT_TRUE(chosen("membrane_obstacle", 1, 1));
  EXPECT_TRUE(chosen("membrane_obstacle", 1, 20));
}

TEST(ContactCost, DoesAsItIsTold) {
  Problem problem(PETSC_COMM_WORLD, make_scene("two_disks"), {});
  HfOptions options;
  options.contact = HfContact::eliminated;
  EXPECT_TRUE(eliminates(problem, options));
  options.method = HfMethod::uzawa;
  EXPECT_FALSE(eliminates(problem, options));
  Problem large(PETSC_COMM_WORLD, make_scene("rigid_disk", {{"kinematics", "large"}}), {});
  options.method = HfMethod::active_set;
  EXPECT_THROW(HighFidelity(large, options), Error);
}

} // namespace
} // namespace rbvi::eliminated_test
