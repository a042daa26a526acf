// A problem of two contact interfaces: two blocks that do not meet, each on a support of its own.
// Together they answer as each of them does by itself.
#include "rbvi/contact/nitsche_support.hpp"
#include "rbvi/solve/high_fidelity.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace rbvi::two_interfaces_test {
namespace {

/// Vertical, at the height that it allows along x.
Support support(const std::string &boundary, double normal, double gap, double slope) {
  return {boundary,
          [=](const FullMu &, const Point &) {
            return Point{0, normal, 0};
          },
          [=](const FullMu &, const Point &x) { return gap + slope * x[0]; }};
}

/// The upper block is pressed onto a floor by the motion of its top, ...
Support floor_support() {
  return support("slave", -1, 0, 0);
}

/// ... the lower one is below a lid that is tilted and too low for it.
Support lid_support() {
  return support("master", 1, -0.01, 0.03);
}

Scene blocks(std::vector<ContactRecipe> contacts, int degree = 2) {
  Scene scene = make_scene("patch", {{"degree", std::to_string(degree)}});
  scene.fixed = {{"top", {}}, {"bottom", {}}};
  scene.contacts = std::move(contacts);
  return scene;
}

Scene blocks(bool with_floor, bool with_lid, bool lumped) {
  Support floor = floor_support(), lid = lid_support();
  floor.lumped = lid.lumped = lumped;
  std::vector<ContactRecipe> contacts;
  if (with_floor) contacts.push_back(rigid_support(floor));
  if (with_lid) contacts.push_back(rigid_support(lid));
  return blocks(std::move(contacts), lumped ? 1 : 2);
}

HfSolution solve(const Scene &scene, const HfOptions &options = {}) {
  Problem problem(PETSC_COMM_WORLD, scene, {});
  return HighFidelity(problem, options).solve({0.05});
}

Vector stacked(const Vector &a, const Vector &b) {
  return (Vector(a.size() + b.size()) << a, b).finished();
}

TEST(TwoInterfaces, AnswerAsEachByItself) {
  for (const bool lumped : {false, true}) {
    const HfSolution floor = solve(blocks(true, false, lumped)),
                     lid = solve(blocks(false, true, lumped)),
                     both = solve(blocks(true, true, lumped));
    EXPECT_GT((lid.lambda.array() == 0).count(), 0) << "the lid is tilted";
    EXPECT_GT(lid.lambda.maxCoeff(), 0);
    EXPECT_LE(both.kkt.largest(), 1e-12);
    EXPECT_LE((both.u - floor.u - lid.u).norm(), 1e-11 * both.u.norm());
    EXPECT_LE((both.lambda - stacked(floor.lambda, lid.lambda)).norm(), 1e-11 * both.lambda.norm());
    const Outputs &f = floor.outputs, &l = lid.outputs, &b = both.outputs;
    EXPECT_NEAR(*b.energy, *f.energy + *l.energy, 1e-11 * *b.energy);
    EXPECT_NEAR(*b.normal_force, *f.normal_force + *l.normal_force, 1e-11 * *b.normal_force);
    EXPECT_NEAR(*b.contact_measure, *f.contact_measure + *l.contact_measure, 1e-12);
    EXPECT_NEAR(*b.reaction, *f.reaction + *l.reaction, 1e-11 * *b.normal_force);
    EXPECT_EQ(*b.contact_nodes, *f.contact_nodes + *l.contact_nodes);
    EXPECT_NEAR(*b.peak_pressure, std::max(*f.peak_pressure, *l.peak_pressure),
                1e-10 * *b.peak_pressure);
  }
}

/// By Nitsche's method, the floor with Coulomb friction.
Scene blocks_by_nitsche(bool with_floor, bool with_lid) {
  Support floor = floor_support();
  floor.friction = {FrictionLaw::coulomb, [](const FullMu &) { return 0.3; }};
  std::vector<ContactRecipe> contacts;
  if (with_floor) contacts.push_back(by_nitsche(rigid_contact(floor), 10));
  if (with_lid) contacts.push_back(by_nitsche(rigid_contact(lid_support()), 10));
  return blocks(std::move(contacts));
}

TEST(TwoInterfaces, ByNitschesMethodAnswerAsEachByItself) {
  const HfSolution floor = solve(blocks_by_nitsche(true, false)),
                   lid = solve(blocks_by_nitsche(false, true)),
                   both = solve(blocks_by_nitsche(true, true));
  EXPECT_LE((both.u - floor.u - lid.u).norm(), 1e-11 * both.u.norm());
  EXPECT_LE((both.lambda - stacked(floor.lambda, lid.lambda)).norm(), 1e-9 * both.lambda.norm());
  const Outputs &f = floor.outputs, &l = lid.outputs, &b = both.outputs;
  EXPECT_NEAR(*b.energy, *f.energy + *l.energy, 1e-11 * *b.energy);
  EXPECT_NEAR(*b.normal_force, *f.normal_force + *l.normal_force, 1e-10 * *b.normal_force);
  EXPECT_NEAR(*b.tangential_force, *f.tangential_force, 1e-9 * *b.tangential_force);
  EXPECT_GT(*f.tangential_force, 0);
  EXPECT_FALSE(l.tangential_force);
}

/// A tilted plate without friction and one that rubs: the difference is of discretisation, as they
/// have nothing but A in common.
TEST(TwoInterfaces, ByNitschesMethodAnswerAsByMultipliers) {
  const auto outputs = [](const char *formulation) {
    Problem problem(PETSC_COMM_WORLD, make_scene("roller", {{"formulation", formulation}}), {});
    return HighFidelity(problem, {}).solve({0.04, 0.1}).outputs;
  };
  const Outputs nitsche = outputs("nitsche"), mixed = outputs("mixed");
  for (const auto member : {&Outputs::energy, &Outputs::normal_force, &Outputs::reaction,
                            &Outputs::horizontal_reaction})
    EXPECT_NEAR(*(nitsche.*member), *(mixed.*member), 2e-3 * std::abs(*(mixed.*member)));
  EXPECT_NEAR(*nitsche.tangential_force, *mixed.tangential_force, 0.03 * *mixed.tangential_force);
  EXPECT_NEAR(*nitsche.peak_pressure, *mixed.peak_pressure, 0.01 * *mixed.peak_pressure);
}

/// The normal displacement of the nodes bounded by the gap: on both.
TEST(TwoInterfaces, ByNitschesMethodWithBoundsDoNotPenetrate) {
  HfOptions bounded;
  bounded.nitsche.nonpenetration = true;
  const HfSolution free = solve(blocks_by_nitsche(true, true)),
                   held = solve(blocks_by_nitsche(true, true), bounded);
  EXPECT_GT(*free.outputs.max_penetration, 1e-8);
  EXPECT_LE(*held.outputs.max_penetration, 1e-14);
  EXPECT_LE((held.u - free.u).norm(), 1e-2 * free.u.norm());
}

/// Where gamma is large P_n is the difference of large numbers, and their round-off ends Newton's
/// method; the bounds change next to nothing.
TEST(NitscheBounds, AreKeptWhereGammaIsLarge) {
  const SceneOptions stiff{
      {"formulation", "nitsche"}, {"nitsche_gamma0", "1154"}, {"friction", "none"}};
  Problem problem(PETSC_COMM_WORLD, make_scene("rigid_disk", stiff), {});
  HfOptions bounded;
  bounded.nitsche.nonpenetration = true;
  for (const double radius : {1.0, 1.3}) {
    const HfSolution free = HighFidelity(problem, {}).solve({radius}),
                     held = HighFidelity(problem, bounded).solve({radius});
    EXPECT_LE(held.iterations, 20);
    EXPECT_LE(*held.outputs.max_penetration, 1e-14);
    EXPECT_NEAR(*held.outputs.energy, *free.outputs.energy, 1e-8);
  }
}

/// Bounds at nodes whose normals differ from interface to interface.
TEST(TwoInterfaces, BoundsAtNodesHaveTheSameAnswer) {
  HfOptions vi;
  vi.method = HfMethod::vi;
  const HfSolution truth = solve(blocks(true, true, true)), s = solve(blocks(true, true, true), vi);
  EXPECT_EQ(s.active, truth.active);
  EXPECT_LE((s.u - truth.u).norm(), 1e-8 * truth.u.norm());
  EXPECT_LE((s.lambda - truth.lambda).norm(), 1e-8 * truth.lambda.norm());
}

} // namespace
} // namespace rbvi::two_interfaces_test
