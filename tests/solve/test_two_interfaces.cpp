// A problem of two contact interfaces: two blocks that do not meet, each on a support of its own.
// Together they answer as each of them does by itself.
#include "rbvi/contact/support/support.hpp"
#include "rbvi/solve/high_fidelity.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace rbvi {
namespace {

/// The upper block is pressed onto a floor by the motion of its top, the lower one is below a lid
/// that is tilted and too low for it.
Scene blocks(bool with_floor, bool with_lid, bool lumped) {
  Scene scene = make_scene("patch", {{"degree", lumped ? "1" : "2"}});
  scene.fixed = {{"top", {}}, {"bottom", {}}};
  const auto gap = [](double height, double slope) {
    return [=](const FullMu &, const Point &x) { return height + slope * x[0]; };
  };
  const auto normal = [](double y) {
    return [=](const FullMu &, const Point &) { return Point{0, y, 0}; };
  };
  scene.contacts.clear();
  if (with_floor)
    scene.contacts.push_back(rigid_support({"slave", normal(-1), gap(0, 0), {}, lumped}));
  if (with_lid)
    scene.contacts.push_back(rigid_support({"master", normal(1), gap(-0.01, 0.03), {}, lumped}));
  return scene;
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
} // namespace rbvi
