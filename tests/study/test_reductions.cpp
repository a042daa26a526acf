// Each reduction of the multipliers where its mathematics allows: on obstacles, between two bodies,
// on supports, with loads.
#include "reduced.hpp"

#include "rbvi/contact/support.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/facet_forms.hpp"
#include "rbvi/mor/reduction.hpp"
#include "rbvi/study/stability_report.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::reductions_test {
namespace {

using namespace testing_reduced;

ReduceOptions condensed_law(double eim = 1e-4) {
  ReduceOptions options;
  options.multipliers.reduction = MultiplierReduction::condensed;
  options.eim.tolerance = eim;
  return options;
}

/// All modes and generators that the samples give.
ReduceOptions all_functions(bool exact) {
  ReduceOptions options;
  options.multipliers.reduction = MultiplierReduction::collocated;
  options.multipliers.exact = exact;
  options.multipliers.tangential = 1e-8;
  options.pod.tolerance = 1e-8;
  options.cone.tolerance = 1e-4;
  options.cone.type = ConeType::mcpg;
  return options;
}

struct Largest {
  double u, lambda, tangential, energy;
};

/// Over parameters that the model has not seen.
Largest errors_of(Reduced &r, const std::string &set) {
  const std::vector<Sample> unseen =
      solve_all(r.problem, parse_set(r.problem.scene().parameters, set));
  const ModelErrors errors = r.errors_at(unseen);
  EXPECT_EQ(errors.failed, 0);
  OnlineSolver online(r.model);
  double energy = 0;
  for (const Sample &sample : unseen) {
    const Outputs outputs = online.outputs(sample.mu, online.solve(sample.mu));
    energy = std::max(energy, std::abs(*outputs.energy - *sample.outputs.energy) /
                                  std::abs(*sample.outputs.energy));
  }
  return {errors.u.maxCoeff(), errors.lambda.maxCoeff(),
          errors.tangential.size() > 0 ? errors.tangential.maxCoeff() : 0, energy};
}

TEST(CondensedLaw, TractionsOnTheSidesOfABlockThatSticksOrSlips) {
  Scene scene = make_scene("patch", {{"bodies", "one"}});
  scene.parameters = free_only(scene.parameters, "indentation,shear,friction_coefficient");
  Reduced r(scene, "grid:2,2,2");
  r.reduce(condensed_law());
  EXPECT_EQ(r.model.body.f.exact, 2);
  const Largest errors = errors_of(r, "random:10:3");
  EXPECT_LE(errors.u, 1e-12);
  EXPECT_LE(errors.lambda, 1e-12);
  EXPECT_LE(errors.tangential, 1e-12);
  EXPECT_LE(errors.energy, 1e-12);
}

TEST(CondensedLaw, AMembraneUnderALoadOnAnObstacle) {
  for (const char *lumped : {"yes", "no"}) {
    SCOPED_TRACE(lumped);
    Scene scene = make_scene("membrane_obstacle", {{"lumped", lumped}, {"circle_edges", "12"}});
    scene.parameters = free_only(scene.parameters, "radius");
    Reduced r(scene, "grid:9");
    r.reduce(condensed_law(1e-11));
    EXPECT_GT(r.model.body.f.interpolation.rows(), 0) << "the load is interpolated";
    const Largest errors = errors_of(r, "random:6:3");
    EXPECT_LE(errors.u, 1e-8);
    EXPECT_LE(errors.lambda, 1e-8);
    EXPECT_LE(errors.energy, 1e-9);
  }
}

/// A pressure on the upper plate's side of a block of its own, whose stiffness depends on mu: the
/// response to the load, too.
TEST(CondensedLaw, LoadsOnABodyWhoseStiffnessIsFree) {
  Scene scene = make_scene("rigid_disk", {{"arc_edges", "16"}, {"friction", "none"}});
  scene.parameters = free_only(scene.parameters, "core_stiffness,poisson_ratio");
  scene.f = {exact_term(pressure_load("contact", -0.05, 2, 2))}; // drawn towards the support
  Reduced r(scene, "grid:3,3");
  r.reduce(condensed_law());
  const Largest errors = errors_of(r, "random:8:3");
  EXPECT_LE(errors.u, 1e-6);
  EXPECT_LE(errors.lambda, 1e-7);
  EXPECT_LE(errors.energy, 1e-8);
}

TEST(CondensedLaw, TwoBodiesKeepTheirNodesUnlessAskedOtherwise) {
  Reduced r(make_scene("two_disks", {{"arc_edges", "24"}}), "grid:9");
  r.reduce({});
  EXPECT_TRUE(r.model.contact.law.has_value());
  const Largest errors = errors_of(r, "random:6:3");
  EXPECT_LE(errors.u, 1e-6);
  EXPECT_LE(errors.lambda, 1e-9);
  ReduceOptions cone;
  cone.multipliers.reduction = MultiplierReduction::cone;
  r.reduce(cone);
  EXPECT_FALSE(r.model.contact.law.has_value());
}

TEST(Reductions, AConeWithSupremizersServesASupportWithoutFriction) {
  Reduced r(make_scene("rigid_disk", {{"arc_edges", "40"}, {"friction", "none"}}), "grid:31");
  ReduceOptions options;
  options.multipliers.reduction = MultiplierReduction::cone;
  options.pod.tolerance = 1e-8;
  options.eim.tolerance = 1e-10;
  r.reduce(options);
  EXPECT_GT(r.model.body.supremizers, 0);
  EXPECT_FALSE(r.model.contact.law.has_value());
  const Largest errors = errors_of(r, "random:8:3");
  EXPECT_LE(errors.u, 1e-5);
  EXPECT_LE(errors.lambda, 1e-4);
  EXPECT_LE(errors.energy, 1e-6);
}

/// A plate above and one below share modes, a cone for each, and supremizers of both together.
TEST(Reductions, AConeForEachOfTwoInterfacesMeetsItsTargets) {
  const Scene scene = make_scene("roller", {{"friction", "none"}});
  Reduced r(scene, scene.training);
  ReduceOptions options;
  options.multipliers.reduction = MultiplierReduction::cone;
  r.reduce(options);
  const Largest errors = errors_of(r, scene.validation);
  EXPECT_LE(errors.u, 1e-5);
  EXPECT_LE(errors.lambda, 1e-4);
  const std::vector<Mu> unseen = parse_set(scene.parameters, "random:6:1");
  for (const InfSup &at :
       infsup_over(PETSC_COMM_WORLD, r.problem, make_stability_check(r.problem, r.model),
                   at_rest(unseen), r.model.contact.b.size() == 1))
    EXPECT_GE(at.off, 0.9 * at.on);
}

TEST(Reductions, CollocationServesAnObstacle) {
  Scene scene = make_scene("membrane_obstacle", {{"circle_edges", "12"}});
  scene.parameters = free_only(scene.parameters, "radius");
  Reduced r(scene, "grid:21");
  ReduceOptions options;
  options.multipliers.reduction = MultiplierReduction::collocated;
  options.cone.type = ConeType::mcpg;
  options.eim.tolerance = 1e-8;
  r.reduce(options);
  const Largest errors = errors_of(r, "random:6:3");
  EXPECT_LE(errors.u, 1e-4);
  EXPECT_LE(errors.lambda, 1e-4);
}

/// Two interfaces in one problem, the lower one with friction or neither, by a reduction that
/// once was that of a single support. The functions hold all training samples.
TEST(Reductions, CollocationServesSeveralInterfacesWithLawsOfTheirOwn) {
  for (const char *friction : {"none", "coulomb"}) {
    Scene scene = make_scene("roller", {{"arc_edges", "16"}, {"friction", friction}});
    scene.parameters = free_only(scene.parameters, "top");
    Reduced r(scene, "grid:25");
    for (const bool exact : {true, false}) {
      SCOPED_TRACE(std::string("friction ") + friction + (exact ? ", mended" : ""));
      r.reduce(all_functions(exact));
      EXPECT_LT(r.model.contact.law->basis.normal.cols(), r.model.contact.law->normal);
      const Largest errors = errors_of(r, "random:6:3");
      EXPECT_LE(errors.u, exact ? 1e-5 : 1e-3);
      EXPECT_LE(errors.lambda, exact ? 1e-5 : 5e-3);
      EXPECT_LE(errors.tangential, exact ? 1e-5 : 1e-2);
      EXPECT_LE(errors.energy, exact ? 1e-6 : 1e-3);
    }
  }
}

/// Two bodies, B evaluated at each mu: it is exact, without interpolation.
TEST(Reductions, CollocationServesTwoBodies) {
  Reduced r(make_scene("two_disks", {{"arc_edges", "24"}}), "grid:25");
  for (const bool exact : {true, false}) {
    SCOPED_TRACE(exact ? "mended" : "not mended");
    r.reduce(all_functions(exact));
    EXPECT_EQ(r.model.contact.b.size(), 0);
    EXPECT_TRUE(r.model.evaluates_contact());
    const Largest errors = errors_of(r, "random:6:3");
    EXPECT_LE(errors.u, 5e-3);
    EXPECT_LE(errors.lambda, exact ? 1e-3 : 5e-2);
    EXPECT_LE(errors.energy, 1e-3);
  }
}

/// Where B stays the condensed operator is kept from the second query on.
TEST(Reductions, LaterQueriesOfTwoBodiesAnswerAsFirstOnes) {
  Reduced r(make_scene("patch"), "grid:3");
  r.reduce(condensed_law());
  EXPECT_TRUE(r.model.evaluates_contact());
  OnlineSolver online(r.model);
  for (const Mu &mu : parse_set(r.problem.scene().parameters, "random:4:1")) {
    const ReducedAnswer later = online.solve(mu), first = OnlineSolver(r.model).solve(mu);
    EXPECT_GT(first.lambda.norm(), 0.1);
    EXPECT_LE((later.lambda - first.lambda).norm(), 1e-12 * first.lambda.norm());
    EXPECT_LE((later.u - first.u).norm(), 1e-12 * first.u.norm());
  }
}

TEST(Reductions, CollocationOfTwoBodiesReturnsItsTrainingSamples) {
  Reduced r(make_scene("two_disks", {{"arc_edges", "24"}}), "grid:9");
  ReduceOptions options = everything();
  options.multipliers.reduction = MultiplierReduction::collocated;
  options.multipliers.exact = false;
  options.cone.type = ConeType::mcpg;
  r.reduce(options);
  EXPECT_GT(r.model.body.supremizers, 0);
  EXPECT_EQ(r.model.contact.law->condensed.terms.size(), 0);
  const ModelErrors errors = r.errors_at(r.samples);
  EXPECT_EQ(errors.failed, 0);
  EXPECT_LE(errors.u.maxCoeff(), 1e-8);
  EXPECT_LE(errors.lambda.maxCoeff(), 1e-6);
}

TEST(Reductions, ContactThatFollowsTheDisplacementHasNoFixedOperator) {
  const Scene scene = make_scene("two_disks", {{"kinematics", "large"}});
  ReduceOptions options;
  options.multipliers.reduction = MultiplierReduction::collocated;
  try {
    check_reduction(scene, options);
    FAIL() << "accepted";
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::bad_input);
    EXPECT_NE(std::string(error.what()).find("changes with every step"), std::string::npos);
  }
}

/// A block between walls that hold it, pressed from above onto a plate that tilts: the functions at
/// the corners are joined to those beside them, in B and g interpolated, too.
Scene block_between_walls(bool friction) {
  Scene scene = make_scene("patch", {{"bodies", "one"}});
  scene.parameters = free_only(scene.parameters, "indentation,shear");
  scene.motion = {};
  scene.fixed = {{"sides", {}}};
  scene.f = {
      exact_term(pressure_load("top", 1, 2, scene.degree), {{"load", affine(1, 5, 0), {0}}})};
  RigidSurface plate{"contact",
                     plane_surface({0, -1, 0}, {0.5, 0, 0}, constant(0), affine(0, 0.05, 1))};
  if (friction) plate.friction = {FrictionLaw::coulomb, constant(0.3)};
  scene.contacts = {rigid_surface(plate)};
  return scene;
}

TEST(JoinedFunctions, AreReducedLikeOthers) {
  for (const bool friction : {false, true})
    for (const MultiplierReduction reduction :
         {MultiplierReduction::condensed, MultiplierReduction::collocated,
          MultiplierReduction::cone}) {
      if (friction && reduction == MultiplierReduction::cone) continue;
      SCOPED_TRACE(multiplier_reduction_names()[static_cast<std::size_t>(reduction)] +
                   (friction ? ", friction" : ""));
      Reduced r(block_between_walls(friction), "grid:5,5");
      EXPECT_LT(r.problem.contact().nodes(),
                r.problem.contact().interfaces.front()->mesh().count());
      ReduceOptions options = everything();
      options.multipliers.reduction = reduction;
      if (reduction != MultiplierReduction::cone) options.cone.type = ConeType::mcpg;
      options.eim.tolerance = 1e-10;
      r.reduce(options);
      EXPECT_GT(r.model.contact.b.interpolation.rows(), 1) << "B is interpolated";
      const Largest errors = errors_of(r, "random:6:3");
      EXPECT_LE(errors.u, reduction == MultiplierReduction::condensed ? 1e-12 : 1e-5);
      EXPECT_LE(errors.lambda, reduction == MultiplierReduction::condensed ? 1e-12 : 1e-5);
      EXPECT_LE(errors.tangential, reduction == MultiplierReduction::condensed ? 1e-12 : 1e-4);
      const ModelErrors of_training = r.errors_at(r.samples); // without tilt there is no gap at all
      EXPECT_EQ(of_training.failed, 0);
      EXPECT_LE(of_training.lambda.maxCoeff(), 1e-5);
    }
}

} // namespace
} // namespace rbvi::reductions_test
