// Hertz contact with friction on a rigid disk: against values found by another code, by symmetry,
// by the balance of forces and work, and where the parameters go to their ends.
#include "rbvi/core/error.hpp"
#include "rbvi/solve/high_fidelity.hpp"
#include "rbvi/solve/methods.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rbvi::rigid_disk_test {
namespace {

/// Free: radius, indentation, friction, core_stiffness, poisson_ratio.
Scene disk(SceneOptions options = {}) {
  Scene scene = make_scene("rigid_disk", options);
  scene.parameters.free = {0, 1, 2, 3, 4};                    // all but the offset
  if (!has_friction(scene)) scene.parameters.free.pop_back(); // there is no such parameter
  return scene;
}

Mu with_radius(double radius, double friction = 0.2, double indentation = 0.09) {
  return {radius, indentation, friction, 1, 0.35};
}

/// Without the value of friction where there is none.
Mu suited(Mu mu, const Scene &scene) {
  if (!has_friction(scene)) mu.erase(mu.begin() + 2);
  return mu;
}

HfSolution solve(const Scene &scene, const Mu &mu, const HfOptions &options = {}) {
  Problem problem(PETSC_COMM_WORLD, scene, {});
  return HighFidelity(problem, options).solve(suited(mu, scene));
}

const SceneOptions small{{"arc_edges", "40"}};

SceneOptions small_with(const std::string &name, const std::string &value) {
  SceneOptions options = small;
  options[name] = value;
  return options;
}

/// The parts of lambda.
struct Parts {
  Vector normal, tangential;
  explicit Parts(const HfSolution &s)
      : normal(s.lambda.head(s.lambda.size() / 2)), tangential(s.lambda.tail(normal.size())) {}
};

// Computed independently on meshes graded towards the clamped corners.
struct Known {
  double radius, energy, force, tangential, peak, half_width, stick;
};
const Known known[] = {{0.7, 0.047121, 1.19502, 0.1920, 4.120, 0.20272, 0.0436},
                       {1.0, 0.041290, 1.02905, 0.1657, 3.469, 0.20395, 0.0437},
                       {1.3, 0.037741, 0.93164, 0.1502, 3.106, 0.20461, 0.0440}};

/// Tresca's law with this threshold; free: radius.
Scene with_threshold(double threshold) {
  Scene scene = make_scene("rigid_disk", small_with("friction", "tresca"));
  scene.parameters.free = {0};
  scene.parameters.all[2].lower = scene.parameters.all[2].upper = threshold;
  scene.parameters.all[2].value = threshold;
  return scene;
}

/// However far the threshold is above all stresses, the answer is that of bodies that stick, and as
/// good: the round-off of the slip is no violation. A slip is one.
TEST(RigidDisk, AThresholdAboveAllStressesIsGlue) {
  const HfSolution sticks = solve(with_threshold(1e2), {1.0});
  for (const HfContact contact : {HfContact::condensed, HfContact::eliminated}) {
    HfOptions options;
    options.contact = contact;
    const HfSolution glued = solve(with_threshold(1.5e5), {1.0}, options);
    EXPECT_LE(glued.kkt.largest(), 1e-10);
    EXPECT_LE((glued.u - sticks.u).norm(), 1e-9 * sticks.u.norm());
    EXPECT_EQ(*glued.outputs.stick_nodes, *glued.outputs.contact_nodes);
  }
  Problem slips(PETSC_COMM_WORLD, with_threshold(1e-3), {}),
      glues(PETSC_COMM_WORLD, with_threshold(1.5e5), {});
  const Handle<KSP> ksp = make_direct_solver(slips.comm(), "hf_");
  const Operators &op = slips.assemble({1.0}), &other = glues.assemble({1.0});
  set_operator(ksp.get(), op.a);
  FactoredBody body(ksp.get(), slips.trace(), ColumnsLast::for_one_b);
  body.set(op.a);
  const MethodResult found = solve_active_set(body, op, {});
  ASSERT_TRUE(found.converged) << found.reason;
  EXPECT_LE(kkt_residual(slips.trace(), op, found.free_u.get(), found.lambda).friction, 1e-10);
  EXPECT_GE(kkt_residual(glues.trace(), other, found.free_u.get(), found.lambda).friction, 1e-2);
  const Vector none = Vector::Zero(found.lambda.size()); // a slip that nothing opposes
  EXPECT_GT(kkt_residual(glues.trace(), other, found.free_u.get(), none).friction, 1e-2);
}

TEST(RigidDisk, AgreesWithTheKnownValues) {
  Problem problem(PETSC_COMM_WORLD, disk(), {});
  HighFidelity solver(problem, {});
  for (const Known &k : known) {
    SCOPED_TRACE(k.radius);
    const HfSolution s = solver.solve(with_radius(k.radius));
    const double edge = k.radius * M_PI / 400;
    EXPECT_NEAR(*s.outputs.energy, k.energy, 1e-4 * k.energy);
    EXPECT_NEAR(*s.outputs.normal_force, k.force, 1e-4 * k.force);
    EXPECT_NEAR(*s.outputs.tangential_force, k.tangential, 1e-3 * k.tangential);
    EXPECT_NEAR(*s.outputs.peak_pressure, k.peak, 1e-3 * k.peak);
    EXPECT_NEAR(*s.outputs.contact_half_width, k.half_width, edge);
    EXPECT_NEAR(*s.outputs.stick_half_width, k.stick, edge);
    EXPECT_NEAR(*s.outputs.contact_nodes * edge, k.half_width * 2, 2 * edge);
    EXPECT_NEAR(*s.outputs.stick_nodes * edge, k.stick * 2, 2 * edge);
    EXPECT_LE(s.kkt.largest(), 1e-12);
    EXPECT_LE(*s.outputs.friction_violation, 1e-13 * k.peak);
  }
}

// On a mesh graded far more steeply to the singular points, of 119000 nodes: energy and force to
// 2e-5. On meshes whose interface is made of chords of the circle |x| = 0.6, ten times farther off
// at the default size and of second order, the energies extrapolate to the same within 3e-5.
struct OfCore {
  double stiffness, energy, force;
};
const OfCore of_core[] = {{0.2, 0.0234070, 0.558992}, {5, 0.0602291, 1.569565}};

TEST(RigidDisk, ASoftOrStiffCoreConverges) {
  for (const OfCore &k : of_core) {
    SCOPED_TRACE(k.stiffness);
    double errors[2][2];
    for (const int refine : {0, 1}) {
      Problem problem(PETSC_COMM_WORLD, disk(), {"", refine});
      const HfSolution s = HighFidelity(problem, {}).solve({1, 0.09, 0.2, k.stiffness, 0.35});
      errors[refine][0] = std::abs(*s.outputs.energy / k.energy - 1);
      errors[refine][1] = std::abs(*s.outputs.normal_force / k.force - 1);
    }
    for (const int i : {0, 1}) {
      EXPECT_LE(errors[0][i], 5e-4);
      EXPECT_GE(std::log2(errors[0][i] / errors[1][i]), 1.8);
    }
  }
}

/// The mesh is, so that the solutions are.
TEST(RigidDisk, SolutionsAreSymmetric) {
  for (const double radius : {0.7, 1.0, 1.3}) {
    const Parts lambda(solve(disk(), with_radius(radius)));
    const double peak = lambda.normal.maxCoeff();
    EXPECT_LE((lambda.normal - lambda.normal.reverse()).cwiseAbs().maxCoeff(), 1e-12 * peak);
    EXPECT_LE((lambda.tangential + lambda.tangential.reverse()).cwiseAbs().maxCoeff(),
              1e-12 * peak);
  }
}

/// dJ/dd = Fy holds without friction, for the discrete problem too.
TEST(RigidDisk, TheReactionIsTheDerivativeOfTheEnergyWithoutFriction) {
  Problem problem(PETSC_COMM_WORLD, disk(small_with("friction", "none")), {});
  HighFidelity solver(problem, {});
  const double d = 0.07, step = 1e-5;
  const auto energy = [&](double indentation) {
    return *solver.solve({0.8, indentation, 1, 0.35}).outputs.energy;
  };
  const HfSolution s = solver.solve({0.8, d, 1, 0.35});
  const double derivative = (energy(d + step) - energy(d - step)) / (2 * step);
  EXPECT_NEAR(*s.outputs.reaction, derivative, 1e-5 * derivative);
  EXPECT_GT(*s.outputs.reaction, *s.outputs.normal_force * 0.98);
  EXPECT_LT(*s.outputs.reaction, *s.outputs.normal_force * 1.02);
}

/// On each rank by itself: thousands of solves with a factorisation that is spread over ranks take
/// long.
TEST(RigidDisk, UzawaAndActiveSetAgree) {
  for (const std::string law : {"none", "tresca", "coulomb"}) {
    SceneOptions options{{"arc_edges", "20"}, {"friction", law}};
    Problem problem(PETSC_COMM_SELF, disk(options), {});
    const Mu mu = suited(with_radius(0.9, 0.1), problem.scene());
    const HfSolution truth = HighFidelity(problem, {}).solve(mu);
    HfOptions uzawa;
    uzawa.method = HfMethod::uzawa;
    uzawa.uzawa.tolerance = 1e-8;
    const HfSolution other = HighFidelity(problem, uzawa).solve(mu);
    // The criterion bounds the last step, not the error, which is larger by the condition.
    EXPECT_LE((other.lambda - truth.lambda).norm(), 1e-4 * truth.lambda.norm()) << law;
    EXPECT_NEAR(*other.outputs.energy, *truth.outputs.energy, 1e-6) << law;
  }
}

TEST(RigidDisk, NoFrictionIsWhatAllLawsEndIn) {
  const HfSolution none = solve(disk(small_with("friction", "none")), with_radius(1));
  for (const std::string law : {"tresca", "coulomb"}) {
    const Parts s(solve(disk(small_with("friction", law)), with_radius(1, 0)));
    EXPECT_LE((s.normal - none.lambda).norm(), 1e-12 * none.lambda.norm()) << law;
    EXPECT_EQ(s.tangential.norm(), 0) << law;
  }
}

TEST(RigidDisk, HighFrictionAndThresholdSticksEverywhere) {
  Scene coulomb = disk(small);
  Scene tresca = disk(small_with("friction", "tresca"));
  SceneOptions in_contact = small_with("friction", "tresca");
  in_contact["friction_bound"] = "contact";
  Scene contact = disk(in_contact);
  const HfSolution c = solve(coulomb, with_radius(1, 100)), t = solve(contact, with_radius(1, 1e3));
  EXPECT_LE((c.lambda - t.lambda).norm(), 1e-10 * c.lambda.norm())
      << "both stick wherever there is contact";
  EXPECT_NEAR(*c.outputs.stick_half_width, *c.outputs.contact_half_width, 1e-14);
  const Parts everywhere(solve(tresca, with_radius(1, 1e3)));
  EXPECT_GT((everywhere.tangential.array() != 0).count(), (c.lambda.array() > 0).count())
      << "on the arc Tresca's bound holds beside the contact too";
}

TEST(RigidDisk, TrescasBoundIsReachedWhereItSlips) {
  const Parts s(solve(disk(small_with("friction", "tresca")), with_radius(1, 0.1)));
  EXPECT_LE(s.tangential.cwiseAbs().maxCoeff(), 0.1 * (1 + 1e-12));
  EXPECT_NEAR(s.tangential[0], -s.tangential[s.tangential.size() - 1], 1e-12);
  EXPECT_NEAR(std::abs(s.tangential[0]), 0.1, 1e-12) << "beside the contact the bound acts too";
}

TEST(RigidDisk, TouchesAtOneNodeAtFirst) {
  const HfSolution s = solve(disk(), with_radius(1, 0.2, 0.00105));
  EXPECT_EQ(s.active.size(), 1u);
  EXPECT_EQ(s.active.front(), 50);
  const HfSolution apart = solve(disk(), with_radius(1, 0.2, 0.0009));
  EXPECT_TRUE(apart.active.empty());
  EXPECT_EQ(apart.u.norm(), 0);
}

TEST(RigidDisk, EveryGapAndNormalHasItsForce) {
  std::map<std::string, double> force;
  for (const std::string gap : {"closest", "ray", "vertical"})
    force[gap] = *solve(disk(small_with("gap", gap)), with_radius(1)).outputs.normal_force;
  EXPECT_GT(std::abs(force["ray"] / force["closest"] - 1), 1e-3);
  EXPECT_GT(std::abs(force["vertical"] / force["closest"] - 1), 1e-3);
  for (const auto &[gap, value] : force)
    EXPECT_NEAR(value, force["closest"], 0.06 * force["closest"]) << gap;
  const double rigid =
      *solve(disk(small_with("normal", "rigid")), with_radius(1)).outputs.normal_force;
  EXPECT_NEAR(rigid, force["closest"], 0.06 * force["closest"]);
}

/// Start from solutions far away: the same answer as from nothing.
TEST(RigidDisk, AnswersDoNotDependOnTheStart) {
  Problem problem(PETSC_COMM_WORLD, disk(small), {});
  HighFidelity solver(problem, {});
  for (const Mu &mu : {with_radius(0.7), with_radius(1.3, 0.5, 0.02), with_radius(0.7, 0.01),
                       with_radius(1, 0.5), with_radius(1.3, 0.05, 0.09)}) {
    const HfSolution warm = solver.solve(mu);
    const HfSolution cold = solve(disk(small), mu);
    EXPECT_LE((warm.lambda - cold.lambda).norm(), 1e-11 * cold.lambda.norm())
        << describe(problem.scene().parameters, mu);
  }
}

TEST(RigidDisk, AStifferCoreAndALessCompressibleBodyPressHarder) {
  const Scene scene = disk(small);
  const auto force = [&](double core, double poisson) {
    return *solve(scene, {1, 0.05, 0.2, core, poisson}).outputs.normal_force;
  };
  EXPECT_GT(force(5, 0.35), force(1, 0.35));
  EXPECT_GT(force(1, 0.35), force(0.2, 0.35));
  EXPECT_GT(force(1, 0.45), force(1, 0.2));
}

TEST(RigidDisk, OneSolveIsTheSameOnAnyNumberOfRanks) {
  Problem shared(PETSC_COMM_WORLD, disk(small), {}), own(PETSC_COMM_SELF, disk(small), {});
  const HfSolution a = HighFidelity(shared, {}).solve(with_radius(0.8));
  const HfSolution b = HighFidelity(own, {}).solve(with_radius(0.8));
  EXPECT_LE((a.u - b.u).norm(), 1e-10 * b.u.norm());
  EXPECT_LE((a.lambda - b.lambda).norm(), 1e-10 * b.lambda.norm());
}

// The same contact on twice the arc; there it goes deeper, and stays off the ends to where the
// scene says that it would reach them.
TEST(RigidDisk, ContactOfTheUndeformedBodyFitsTheWideArc) {
  const Scene narrow = disk(small);
  for (const char *normal : {"radial", "rigid"}) {
    SCOPED_TRACE(normal);
    const Scene wide = disk({{"contact_arc", "wide"}, {"arc_edges", "80"}, {"normal", normal}});
    const HfSolution on_narrow = solve(disk(small_with("normal", normal)), with_radius(1));
    const HfSolution on_wide = solve(wide, with_radius(1));
    EXPECT_NEAR(*on_wide.outputs.energy, *on_narrow.outputs.energy,
                1e-3 * *on_narrow.outputs.energy);
    EXPECT_NEAR(*on_wide.outputs.normal_force, *on_narrow.outputs.normal_force,
                1e-3 * *on_narrow.outputs.normal_force);
    for (const double radius : {0.7, 1.3}) {
      const Mu deepest = with_radius(radius, 0.2, 0.2 * radius);
      EXPECT_THROW(narrow.check_parameters(expand(narrow.parameters, deepest)), Error);
      EXPECT_NO_THROW(wide.check_parameters(expand(wide.parameters, deepest)));
      const HfSolution ends = solve(wide, deepest);
      EXPECT_LT(*ends.outputs.contact_half_width, 0.95 * radius * M_PI / 4);
      const double pressed = ends.lambda[0] > 0 ? 2 : 0; // of a mirrored answer
      EXPECT_EQ(*ends.outputs.ends_in_contact, pressed);
      // Along the radial normal the rigid disk is near again on the sides of a body that is not
      // small beside it.
      const bool near = normal == std::string("radial") && radius > 0.7;
      EXPECT_EQ(pressed, near ? 2 : 0);
      const Mu shallower = with_radius(radius, 0.2, 0.13 * radius);
      EXPECT_EQ(*solve(wide, shallower).outputs.ends_in_contact, 0);
      const Mu deeper = with_radius(radius, 0.2, 0.21 * radius);
      EXPECT_THROW(wide.check_parameters(expand(wide.parameters, deeper)), Error);
    }
  }
}

TEST(RigidDisk, BadInputIsRefused) {
  EXPECT_THROW(make_scene("rigid_disk", {{"young", "0"}}), Error);
  EXPECT_THROW(Problem(PETSC_COMM_WORLD, disk({{"arc_edges", "7"}}), {}), Error);
  HfOptions vi;
  vi.method = HfMethod::vi;
  Problem problem(PETSC_COMM_WORLD, disk(small), {});
  EXPECT_THROW(HighFidelity(problem, vi), Error);
}

} // namespace
} // namespace rbvi::rigid_disk_test
